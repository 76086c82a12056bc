#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

/// Keys of a run between machines: ZeroMQ CURVE (Curve25519), written as ZeroMQ writes them, 40 characters of
/// Z85. `strake keys` makes a folder (0700) with one file (0600) per program, each with all that its program
/// needs:
///   coupler.key          public, secret, admit.<participant> = that participant's public key
///   <participant>.key    name, public, secret, coupler = the coupler's public key
namespace strake {

struct KeyPair {
  std::string public_key, secret_key;  // Z85
};

struct CouplerKeys {
  KeyPair own;
  std::map<std::string, std::string> admitted;  // participant → its public key: whoever else knocks stays out
  std::filesystem::path folder;
};

struct ParticipantKeys {
  std::string name;
  KeyPair own;
  std::string coupler;  // its public key
  std::filesystem::path file;
};

/// Makes the folder and the files. Error(command_line) if keys stand there already, or a name is none;
/// Error(cannot_write).
void make_keys(const std::filesystem::path& folder, const std::vector<std::string>& participants);

/// Read the encryption keys. Both throw Error(case_file) or Error(command_line) for a file that is missing,
/// damaged or readable by others. So they do for a folder that others may enter, and for an owner who is
/// neither this user nor root.
CouplerKeys read_coupler_keys(const std::filesystem::path& folder);
ParticipantKeys read_participant_keys(const std::filesystem::path& file);

/// Where `make_keys` puts the keys of a participant.
std::filesystem::path key_file(const std::filesystem::path& folder, const std::string& participant);

}  // namespace strake
