#include "proto/files/whole_file.hpp"

#include "proto/case/case_file.hpp"
#include "proto/files/history.hpp"
#include "tests/proto/refusal.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <csignal>
#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace strake {
namespace whole_file_test {

TEST(WholeFile, ReadsAllBytesOfAFile) {
  const TemporaryFolder folder;
  const std::string bytes("a\0b\n", 4);
  put(folder / "a", bytes);
  EXPECT_EQ(read_whole(folder / "a", 100, "a"), bytes);
  put(folder / "empty", "");
  EXPECT_EQ(read_whole(folder / "empty", 100, "empty"), "");
}

TEST(WholeFile, WhatNeverEndsIsRefusedAtOnce) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  for (const std::string& path :
       {std::string("/dev/zero"), std::string("/dev/random"), (folder / "pipe").string()}) {
    expect_refused([&] { read_whole(path, any_size, path); }, path + ": is a pipe, a device or a socket");
    expect_refused([&] { CaseFile::load(path); }, path + ": is a pipe, a device or a socket");
    expect_refused([&] { read_given_table(path); }, path + ": is a pipe, a device or a socket");
  }
  expect_refused([&] { read_whole(folder.path(), any_size, "x"); }, "x: is a folder, not a file");
}

TEST(WholeFile, AFileAboveItsSizeIsRefusedBeforeItIsRead) {
  const TemporaryFolder folder;
  put(folder / "a.toml", "end_time = 1");
  std::filesystem::resize_file(folder / "a.toml", std::uintmax_t{1} << 40);  // sparse: takes no room
  expect_refused([&] { CaseFile::load(folder / "a.toml"); }, "has 1.1e+06 MB, at most 16.8 MB are read here");
  expect_refused([&] { read_given_table(folder / "a.toml"); }, "at most 1.07e+03 MB");
}

TEST(WholeFile, AKeyThatNamesAFileRefusesAPipe) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  put(folder / "case.toml", "mesh = \"pipe\"\n");
  CaseFile file = CaseFile::load(folder / "case.toml");
  std::filesystem::path path;
  expect_refused([&] { file.root().file("mesh", path, {}); },
                 "expected a file; this is a pipe, a device or a socket");
}

TEST(WholeFile, AHashReadsNoMoreThanATableMayHave) {
  const TemporaryFolder folder;
  put(folder / "huge", "x");
  std::filesystem::resize_file(folder / "huge", std::uintmax_t{1} << 40);
  put(folder / "case.toml", "title = \"huge\"\n");
  const auto before = CaseFile::load(folder / "case.toml").hash();
  std::filesystem::resize_file(folder / "huge", (std::uintmax_t{1} << 40) + 1);
  EXPECT_NE(CaseFile::load(folder / "case.toml").hash(), before);  // its length still counts
}

// A pipe in the place of the unfinished file holds the write up in the middle.
TEST(WholeFile, AProcessThatMustEndRemovesWhatItIsWriting) {
  const TemporaryFolder folder;
  const std::string path = (folder / "frame.h5").string(), part = path + ".part";
  ASSERT_EQ(mkfifo(part.c_str(), 0600), 0);
  remove_unfinished_file();
  EXPECT_TRUE(std::filesystem::exists(part)) << "nobody writes it";
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  const int reader = open(part.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  ASSERT_GE(reader, 0);
  std::thread writer([&] { EXPECT_THROW(write_whole(path, std::string(1 << 20, 'x')), Error); });
  pollfd ready{reader, POLLIN, 0};
  EXPECT_EQ(poll(&ready, 1, 5000), 1);
  remove_unfinished_file();
  EXPECT_FALSE(std::filesystem::exists(part));
  close(reader);
  writer.join();
  std::signal(SIGPIPE, before);
}

}  // namespace whole_file_test
}  // namespace strake
