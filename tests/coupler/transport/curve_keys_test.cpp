// Key files: who may read them, what is refused, and the words it is refused with.

#include "coupler/transport/curve_keys.hpp"

#include "coupler/transport/sockets.hpp"
#include "tests/coupler/golden.hpp"
#include "tests/proto/refusal.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <sys/stat.h>

namespace strake {
namespace curve_keys_test {

namespace fs = std::filesystem;

mode_t mode_of(const fs::path& path) {
  struct stat found {};
  return stat(path.c_str(), &found) == 0 ? found.st_mode & 07777 : 0;
}

class Keys : public testing::Test {
 protected:
  std::string text_of(const std::function<void()>& act, ExitCode code) {
    return replaced(text_of_error(act, code), place_.path().string() + "/", "");
  }
  void put(const fs::path& file, const std::string& text) {
    strake::put(file, text);
    chmod(file.c_str(), 0600);
  }

  TemporaryFolder place_;
  fs::path folder_ = place_ / "keys";
};

TEST_F(Keys, AreMadePrivateAndReadBack) {
  make_keys(folder_, {"fluid", "structure"});
  EXPECT_EQ(mode_of(folder_), 0700u);
  const CouplerKeys coupler = read_coupler_keys(folder_);
  EXPECT_EQ(coupler.admitted.size(), 2u);
  for (const char* name : {"coupler", "fluid", "structure"})
    EXPECT_EQ(mode_of(key_file(folder_, name)), 0600u);
  const ParticipantKeys fluid = read_participant_keys(key_file(folder_, "fluid"));
  EXPECT_EQ(fluid.name, "fluid");
  EXPECT_EQ(fluid.coupler, coupler.own.public_key);
  EXPECT_EQ(fluid.own.public_key, coupler.admitted.at("fluid"));
  EXPECT_NE(fluid.own.public_key, coupler.admitted.at("structure"));
  EXPECT_TRUE(belong_together(fluid.own));
}

TEST_F(Keys, OfTwoRunsDiffer) {
  make_keys(folder_, {"fluid"});
  make_keys(place_ / "others", {"fluid"});
  EXPECT_NE(read_coupler_keys(folder_).own.secret_key, read_coupler_keys(place_ / "others").own.secret_key);
}

TEST_F(Keys, AreRefusedWhereOthersMayHaveReadThemOrTheyAreDamaged) {
  std::vector<std::pair<std::string, std::string>> texts;
  const auto coupler = [&](const std::string& what) {
    texts.emplace_back(what, text_of([&] { read_coupler_keys(folder_); }, ExitCode::case_file));
  };
  const auto fluid = [&](const std::string& what) {
    texts.emplace_back(
        what, text_of([&] { read_participant_keys(folder_ / "fluid.key"); }, ExitCode::command_line));
  };
  const auto make = [&](const std::string& what, const std::vector<std::string>& names) {
    texts.emplace_back(what, text_of([&] { make_keys(folder_, names); }, ExitCode::command_line));
  };
  make("a participant called coupler", {"coupler"});
  make("a participant whose name is a path", {"../fluid"});
  coupler("no folder of keys");
  make_keys(folder_, {"fluid"});
  make("keys exist", {"fluid"});
  chmod(folder_.c_str(), 0755);
  coupler("a folder that others may enter");
  make("new keys in a folder that others may enter", {"fluid"});
  chmod(folder_.c_str(), 0700);
  chmod((folder_ / "coupler.key").c_str(), 0640);
  coupler("a key that the group may read");
  chmod((folder_ / "fluid.key").c_str(), 0644);
  fluid("a participant's key that all may read");
  fs::copy_file(folder_ / "coupler.key", folder_ / "keep");
  put(folder_ / "fluid.key", "public = \"a\"\nsecret\n");
  fluid("a line that is none");
  put(folder_ / "fluid.key", "name = \"fluid\"\npublic = \"short\"\n");
  fluid("a key that is too short");
  put(folder_ / "fluid.key", "name = \"fluid\"\n");
  fluid("a key that is missing");
  const KeyPair one = new_key_pair(), other = new_key_pair();
  put(folder_ / "fluid.key",
      "name = \"fluid\"\npublic = \"" + one.public_key + "\"\nsecret = \"" + other.secret_key + "\"\n");
  fluid("a public key of another secret");
  put(folder_ / "fluid.key", "public = \"" + one.public_key + "\"\nsecret = \"" + one.secret_key + "\"\n");
  fluid("the coupler's key at a participant");
  fs::remove(folder_ / "fluid.key");
  fluid("no key file");
  fs::create_directory(folder_ / "fluid.key");
  fluid("a folder for a key file");
  expect_golden(fs::path(STRAKE_SOURCE_DIR) / "tests/text/key_errors.txt", texts);
}

}  // namespace curve_keys_test
}  // namespace strake
