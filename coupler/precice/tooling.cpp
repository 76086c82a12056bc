// Functions of preCICE that need no run.

#include "coupler/precice/guarded_call.hpp"

#include <precice/Tooling.hpp>

#include <ostream>

namespace precice {
namespace tooling {

void printConfigReference(std::ostream& out, ConfigReferenceType) {
  out << "Strake reads of a preCICE configuration, in this order, and passes over the rest:\n"
         "  <data:scalar | data:vector  name  waveform-degree>\n"
         "  <mesh  name  dimensions>       with <use-data  name>\n"
         "  <participant  name>            with <provide-mesh  name>, <receive-mesh  name>, <write-data  "
         "name  mesh>,\n"
         "                                 <read-data  name  mesh>, <mapping:KIND  from  to  constraint>\n"
         "  <coupling-scheme:KIND>         with <participants  first  second>, <exchange  data  mesh  from  "
         "to\n"
         "                                 initialize  substeps>\n"
         "Mapping, acceleration, times and limits are those of the case file.\n";
}

void checkConfiguration(const std::string& file, const std::string& participant, int size) {
  strake::guarded_call("tooling::checkConfiguration()", nullptr, [&] {
    const strake::PreciceConfig config = strake::PreciceConfig::read(file);
    strake::checked_participant(config, participant, 0, size);
  });
}

}  // namespace tooling

std::string getVersionInformation() {
  return strake::precice_version;
}

}  // namespace precice
