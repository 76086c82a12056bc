#include "proto/files/result_file.hpp"

#include "proto/files/frame_file.hpp"
#include "proto/files/hdf5_file.hpp"
#include "tests/proto/refusal.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <array>
#include <csignal>
#include <fstream>
#include <limits>
#include <sys/resource.h>
#include <utility>

namespace strake {
namespace result_file_test {

Archive some_archive() {
  Archive archive;
  archive.real["position"] = Eigen::MatrixXd::Random(3, 7);
  archive.real["probe/p_mid.recent"] = Eigen::MatrixXd(3, 0);
  archive.real["."] = Eigen::MatrixXd::Constant(1, 1, std::numeric_limits<double>::quiet_NaN());
  archive.real["100%"] = Eigen::MatrixXd::Constant(2, 2, std::numeric_limits<double>::infinity());
  archive.integer["id"] = {std::numeric_limits<std::int64_t>::min(), 0, 42};
  archive.integer["position"] = {};
  return archive;
}

Frame some_frame(double time) {
  Frame frame;
  frame.time = time;
  frame.position = Points::Random(3, 6);
  frame.cells.resize(4, 2);
  frame.cells << 0, 1, 1, 2, 4, 5, 3, 4;
  frame.point_data = {{"velocity", "m/s", Eigen::MatrixXd::Random(2, 6)},
                      {"p", "Pa", Eigen::MatrixXd::Random(1, 6)}};
  frame.cell_data = {{"stress & strain", "Pa", Eigen::MatrixXd::Random(6, 2)}};
  return frame;
}

TEST(Archive, ComesBackBitForBitWithEveryName) {
  const TemporaryFolder folder;
  const Archive archive = some_archive();
  write_archive(folder / "a.h5", archive);
  const Archive back = read_archive(folder / "a.h5");
  EXPECT_EQ(back.integer, archive.integer);
  ASSERT_EQ(back.real.size(), archive.real.size());
  for (const auto& [name, value] : archive.real) {
    const Eigen::MatrixXd& other = back.real.at(name);
    ASSERT_EQ(other.rows(), value.rows()) << name;
    ASSERT_EQ(other.cols(), value.cols()) << name;
    const auto bytes = static_cast<std::size_t>(value.size()) * sizeof(double);
    EXPECT_TRUE(bytes == 0 || std::memcmp(other.data(), value.data(), bytes) == 0) << name;
  }
}

TEST(Archive, EqualContentIsEqualBytesAndNothingIsLeftAside) {
  const TemporaryFolder folder;
  const Archive archive = some_archive();
  write_archive(folder / "a.h5", archive);
  const std::string first = content(folder / "a.h5");
  write_archive(folder / "a.h5", archive);
  EXPECT_EQ(content(folder / "a.h5"), first);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.h5.part"));
}

TEST(Archive, ValuesMadeOneByOneGiveTheSameBytes) {
  const TemporaryFolder folder;
  const Archive archive = some_archive();
  write_archive(folder / "a.h5", archive);
  ArchiveSource source;
  for (const auto& [name, value] : archive.real) source.real[name] = [&value] { return value; };
  for (const auto& [name, value] : archive.integer) source.integer[name] = [&value] { return value; };
  write_archive(folder / "b.h5", source);
  EXPECT_EQ(content(folder / "b.h5"), content(folder / "a.h5"));
}

/// A line of /proc/self/status [bytes].
[[maybe_unused]] double status(const std::string& name) {
  std::ifstream file("/proc/self/status");
  std::string word;
  double value = 0;
  while (file >> word)
    if (word == name + ":" && file >> value) return 1024 * value;
  return 0;
}

/// Memory that a call takes at its peak, beside what there was before [bytes]; nothing where the system does
/// not tell.
template <class Call>
std::optional<double> peak_of(Call&& call) {
#ifdef STRAKE_SANITIZED
  call();
  return std::nullopt;  // sanitizers keep what is freed
#else
  std::ofstream clear("/proc/self/clear_refs");
  if (!(clear << "5" << std::flush)) return std::nullopt;  // sets the peak to what is in use
  const double before = status("VmRSS");
  call();
  return status("VmHWM") - before;
#endif
}

TEST(Archive, IsWrittenWithTheMemoryOfItsFileAndOfOneValueTwice) {
  const TemporaryFolder folder;
  constexpr Eigen::Index n = 1 << 20;  // 8 MiB a value
  constexpr int values = 8;
  ArchiveSource source;
  for (int k = 0; k < values; ++k)
    source.real["value " + std::to_string(k)] = [k] { return Eigen::MatrixXd::Constant(1, n, k + 0.5); };
  const auto peak = peak_of([&] { write_archive(folder / "a.h5", source); });
  if (!peak) GTEST_SKIP() << "the peak of memory is not known here";
  const auto size = static_cast<double>(std::filesystem::file_size(folder / "a.h5"));
  EXPECT_LT(*peak, 1.4 * size);
  EXPECT_GT(*peak, 0.9 * size);
}

TEST(FrameSeries, WritesAFrameWithTheMemoryOfItsFile) {
  const TemporaryFolder folder;
  Frame frame;
  constexpr Eigen::Index n = 1 << 20;
  frame.position = Points::Constant(3, n, 0.5);
  for (const char* name : {"a", "b", "c", "d"})
    frame.point_data.push_back({name, "1", Eigen::MatrixXd::Constant(1, n, 0.25)});
  FrameSeries series(folder.path(), "fluid", 3);
  const auto peak = peak_of([&] { series.write(frame); });
  if (!peak) GTEST_SKIP() << "the peak of memory is not known here";
  EXPECT_LT(*peak, 1.4 * static_cast<double>(std::filesystem::file_size(folder / "frames/fluid-000000.h5")));
}

TEST(Archive, CutAtAnyLengthIsAnErrorThatNamesTheFile) {
  const TemporaryFolder folder;
  write_archive(folder / "a.h5", some_archive());
  const std::string bytes = content(folder / "a.h5");
  ASSERT_GT(bytes.size(), 500u);
  for (std::size_t length = 0; length < bytes.size(); length += bytes.size() / 60 + 1) {
    put(folder / "cut.h5", bytes.substr(0, length));
    EXPECT_NE(text_of_error([&] { read_archive(folder / "cut.h5"); }, ExitCode::case_file).find("cut.h5: "),
              std::string::npos)
        << length;
  }
}

TEST(Archive, WithDamagedBytesIsReadOrRefusedButNeverCrashes) {
  const TemporaryFolder folder;
  write_archive(folder / "a.h5", some_archive());
  const std::string bytes = content(folder / "a.h5");
  for (std::size_t i = 0; i < bytes.size(); i += 97) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(~damaged[i]);
    put(folder / "b.h5", damaged);
    try {
      read_archive(folder / "b.h5");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::case_file);
    }
  }
}

TEST(Archive, RefusesWhatIsNotOurs) {
  const TemporaryFolder folder;
  put(folder / "a.h5", "time [s]\n1\n");
  const auto text = [&](const std::string& name) {
    return text_of_error([&] { read_archive(folder / name); }, ExitCode::case_file);
  };
  EXPECT_NE(text("a.h5").find("is no HDF5 file"), std::string::npos);
  EXPECT_NE(text("b.h5").find("no such file"), std::string::npos);
  EXPECT_NE(text(".").find("is no file"), std::string::npos);
  hdf5::Writer other;
  other.attribute("/", "format", std::string("somebody's"));
  other.save(folder / "c.h5");
  EXPECT_NE(text("c.h5").find("is HDF5, but no strake archive 1"), std::string::npos);
}

TEST(Archive, SaysWhyItCannotBeWritten) {
  const TemporaryFolder folder;
  EXPECT_NE(text_of_error([&] { write_archive(folder / "no/a.h5", some_archive()); }, ExitCode::cannot_write)
                .find("no/a.h5: cannot be written: No such file or directory"),
            std::string::npos);
}

TEST(Archive, OnADiskThatFillsLeavesTheOlderFileWhole) {
  const TemporaryFolder folder;
  Archive archive = some_archive();
  write_archive(folder / "a.h5", archive);
  const std::string before = content(folder / "a.h5");
  archive.real["large"] = Eigen::MatrixXd::Ones(100, 1000);
  // A limit on the size of files stands in for a full disk: the write fails part of the way.
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const rlimit small{100000, old.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string text =
      text_of_error([&] { write_archive(folder / "a.h5", archive); }, ExitCode::cannot_write);
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);
  EXPECT_NE(text.find("a.h5: cannot be written: File too large"), std::string::npos) << text;
  EXPECT_EQ(content(folder / "a.h5"), before);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.h5.part"));
}

TEST(FrameSeries, WritesPointsCellsAndFieldsAsTheFrameHasThem) {
  const TemporaryFolder folder;
  const Frame frame = some_frame(0.25);
  FrameSeries(folder.path(), "structure", 2).write(frame);
  const hdf5::Reader file(folder / "frames/structure-000000.h5", "strake frame 1");
  EXPECT_EQ(file.number("time"), 0.25);
  EXPECT_EQ(file.real("/position"), frame.position.transpose());
  EXPECT_EQ(file.integer("/cells"), (std::vector<std::int64_t>{0, 1, 4, 3, 1, 2, 5, 4}));
  const Eigen::MatrixXd velocity = file.real("/point/velocity");
  EXPECT_EQ(velocity.leftCols(2), frame.point_data[0].value.transpose());
  EXPECT_EQ(velocity.cols(), 3);  // vectors have three components
  EXPECT_TRUE(velocity.col(2).isZero(0));
  EXPECT_EQ(file.real("/cell/stress & strain"), frame.cell_data[0].value.transpose());
}

/// The text between the first `before` after `from` and the next `after`; moves `from` behind it.
std::string between(const std::string& text, const std::string& before, const std::string& after,
                    std::size_t& from) {
  const std::size_t begin = text.find(before, from);
  if (begin == std::string::npos) return {};
  const std::size_t end = text.find(after, begin + before.size());
  from = end;
  return text.substr(begin + before.size(), end - begin - before.size());
}

TEST(FrameSeries, ListsEachDatasetWithItsShapeAndAPathThatLeadsToIt) {
  const TemporaryFolder folder;
  FrameSeries series(folder.path(), "fluid", 2);
  series.write(some_frame(0));
  Frame points = some_frame(1e-4);
  points.cells.resize(0, 0);
  points.cell_data.clear();
  series.write(points);
  const std::string xdmf = content(folder / "fluid.xdmf");
  EXPECT_NE(xdmf.find("TopologyType=\"Quadrilateral\" NumberOfElements=\"2\""), std::string::npos);
  EXPECT_NE(xdmf.find("TopologyType=\"Polyvertex\" NodesPerElement=\"1\" NumberOfElements=\"6\""),
            std::string::npos);
  EXPECT_NE(xdmf.find("<Time Value=\"0.0001\"/>"), std::string::npos);
  EXPECT_NE(xdmf.find("Name=\"stress &amp; strain\" Center=\"Cell\" AttributeType=\"Tensor6\""),
            std::string::npos);
  int items = 0;
  for (std::size_t from = 0;; ++items) {
    const std::string shape = between(xdmf, "Dimensions=\"", "\"", from);
    if (shape.empty()) break;
    std::string place = between(xdmf, ">", "<", from);
    if (const std::size_t amp = place.find("&amp;"); amp != std::string::npos) place.replace(amp, 5, "&");
    const std::size_t colon = place.find(":/");
    const hdf5::Reader file(folder / place.substr(0, colon), "strake frame 1");  // relative to the list
    const auto size = file.shape(place.substr(colon + 1));
    EXPECT_EQ(shape, std::to_string(size[0]) + " " + std::to_string(size[1])) << place;
  }
  EXPECT_EQ(items, 5 + 4);
}

TEST(FrameSeries, TruncatedAtATimeGoesOnAsIfNothingHadCome) {
  const TemporaryFolder whole, cut;
  std::vector<Frame> frames;
  for (int i = 0; i < 5; ++i) frames.push_back(some_frame(0.1 * i));
  FrameSeries all(whole.path(), "fluid", 2);
  for (const Frame& frame : frames) all.write(frame);
  FrameSeries first(cut.path(), "fluid", 2);
  for (int i = 0; i < 4; ++i) first.write(frames[static_cast<std::size_t>(i)]);
  put(cut / "frames/fluid-000004.h5.part", "killed here");

  FrameSeries second(cut.path(), "fluid", 2);
  second.truncate(0.15);
  EXPECT_EQ(second.count(), 2);
  EXPECT_FALSE(std::filesystem::exists(cut / "frames/fluid-000002.h5"));
  for (int i = 2; i < 5; ++i) second.write(frames[static_cast<std::size_t>(i)]);
  EXPECT_TRUE(content(cut / "fluid.xdmf") == content(whole / "fluid.xdmf"));
  for (int i = 0; i < 5; ++i) {
    const std::string name = "frames/fluid-00000" + std::to_string(i) + ".h5";
    EXPECT_TRUE(content(cut / name) == content(whole / name)) << name;
  }
}

TEST(FrameSeries, GoesOnBesideAFrameThatAPowerCutDamaged) {
  const TemporaryFolder folder;
  FrameSeries first(folder.path(), "fluid", 2);
  for (int i = 0; i < 4; ++i) first.write(some_frame(0.1 * i));
  put(folder / "frames/fluid-000001.h5", "");
  put(folder / "frames/fluid-000003.h5", "");
  FrameSeries second(folder.path(), "fluid", 2);
  second.truncate(0.25);
  EXPECT_EQ(second.count(), 2);  // those at 0 and 0.2 s
  second.write(some_frame(0.3));
  EXPECT_EQ(list_frames(folder.path(), "fluid").size(), 3u);
  EXPECT_EQ(time_of_frame(folder / "frames/fluid-000003.h5"), 0.3);
  EXPECT_EQ(content(folder / "frames/fluid-000001.h5"), "");
}

/// Replaces the root's attribute `time` of a file.
void set_time(const std::filesystem::path& path, hid_t type, hsize_t count, const void* values) {
  const hdf5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  H5Adelete(file.get(), "time");
  const hdf5::Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const hdf5::Handle attribute(H5Acreate2(file.get(), "time", type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                               H5Aclose);
  H5Awrite(attribute.get(), type, values);
}

TEST(Reader, EightSmallNumbersInTheBytesOfOneAreNoNumber) {
  const TemporaryFolder folder;
  FrameSeries(folder.path(), "fluid", 2).write(some_frame(0.5));
  const std::filesystem::path frame = folder / "frames/fluid-000000.h5";
  const std::array<std::int8_t, 8> small{1, 2, 3, 4, 5, 6, 7, 8};
  set_time(frame, H5T_NATIVE_INT8, small.size(), small.data());
  const hdf5::Reader file(frame, hdf5::frame_format);
  EXPECT_NE(text_of_error([&] { static_cast<void>(file.number("time")); }, ExitCode::case_file)
                .find("has no number time"),
            std::string::npos);
  EXPECT_EQ(time_of_frame(frame), std::nullopt);
}

TEST(FrameSeries, GoesOnBesideAFrameOfUnknownCellsOrTime) {
  const TemporaryFolder folder;
  FrameSeries first(folder.path(), "fluid", 2);
  for (int i = 0; i < 4; ++i) first.write(some_frame(0.1 * i));
  const Frame frame = some_frame(0.1);
  hdf5::Writer file;
  file.attribute("/", "format", hdf5::frame_format);
  file.attribute("/", "time", frame.time);
  file.dataset("/position", frame.position.data(), frame.position.cols(), 3);
  file.dataset("/cells", std::vector<std::int64_t>(10, 0), 5);  // nodes of a cell that no solver has
  file.group("/point");
  file.group("/cell");
  file.save(folder / "frames/fluid-000001.h5");
  const double no_time = std::numeric_limits<double>::quiet_NaN();
  set_time(folder / "frames/fluid-000002.h5", H5T_NATIVE_DOUBLE, 1, &no_time);
  EXPECT_EQ(list_frames(folder.path(), "fluid").size(), 3u);  // all whose time is known

  FrameSeries second(folder.path(), "fluid", 2);
  second.truncate(1);
  EXPECT_EQ(second.count(), 2);
  const std::string xdmf = content(folder / "fluid.xdmf");
  for (const auto& [number, listed] : {std::pair(0, true), {1, false}, {2, false}, {3, true}})
    EXPECT_EQ(xdmf.find("fluid-00000" + std::to_string(number)) != std::string::npos, listed) << number;
}

TEST(WriteText, ReplacesAFileWhole) {
  const TemporaryFolder folder;
  write_text(folder / "a.json", "long text");
  write_text(folder / "a.json", "{}");
  EXPECT_EQ(content(folder / "a.json"), "{}");
  text_of_error([&] { write_text(folder.path(), "a folder stands there"); }, ExitCode::cannot_write);
}

}  // namespace result_file_test
}  // namespace strake
