#include "sim/rig/eeprom_store.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "sim/rig/folders.hpp"
#include "tests/support/read_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace vinv::rig {
namespace {

namespace fs = std::filesystem;

class EepromStoreTest : public testing::Test {
 protected:
  static std::string read(const std::string& path) { return vinv::test::read_file(path); }
  const TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
};

TEST_F(EepromStoreTest, ADriveWithoutAFileHasNoEeprom) {
  const EepromStore store(folder_ + "/plants/demo");
  EXPECT_FALSE(store.load("conveyor_1").has_value());
}

TEST_F(EepromStoreTest, WhatIsStoredIsReadBackAndLeavesNoTemporaryFile) {
  EepromStore store(folder_);
  store.store("a", "one");
  store.store("a", "two");
  store.store("b", "three");
  EXPECT_EQ(store.flush(), "");
  EXPECT_EQ(store.load("a"), "two");
  EXPECT_EQ(store.load("b"), "three");
  for (const auto& entry : fs::directory_iterator(folder_)) EXPECT_NE(entry.path().extension(), ".new");
}

TEST_F(EepromStoreTest, TheDestructorWritesWhatIsQueued) {
  {
    EepromStore store(folder_);
    store.store("a", "last words");
  }
  EXPECT_EQ(read(folder_ + "/a.eeprom"), "last words");
}

TEST_F(EepromStoreTest, DamagedFilesAreAllKept) {
  EepromStore store(folder_);
  for (const char* text : {"first", "second"}) {
    store.store("a", text);
    ASSERT_EQ(store.flush(), "");
    store.keep_aside("a");
    EXPECT_FALSE(store.load("a").has_value());
  }
  EXPECT_EQ(read(folder_ + "/a.eeprom.damaged-1"), "first");
  EXPECT_EQ(read(folder_ + "/a.eeprom.damaged-2"), "second");
}

TEST_F(EepromStoreTest, AFailedWriteLeavesTheOldFileAndIsTold) {
  EepromStore store(folder_);
  store.store("a", "good");
  ASSERT_EQ(store.flush(), "");
  fs::create_directory(folder_ + "/a.eeprom.new");  // the temporary file's place is taken
  store.store("a", "better");
  EXPECT_NE(store.flush().find("a.eeprom.new cannot be written"), std::string::npos);
  EXPECT_EQ(store.load("a"), "good");
  EXPECT_EQ(store.take_failure(), "") << "a failure is told once";
  EXPECT_NE(store.flush().find("a.eeprom.new cannot be written"), std::string::npos) << "and again at the next attempt";
}

TEST_F(EepromStoreTest, WhatCouldNotBeWrittenIsWrittenWhenThereIsRoomAgain) {
  EepromStore store(folder_);
  const std::string obstacle = folder_ + "/a.eeprom.new";
  ASSERT_EQ(::mkdir(obstacle.c_str(), 0700), 0);
  store.store("a", "first");
  EXPECT_NE(store.flush(), "");
  ASSERT_EQ(::rmdir(obstacle.c_str()), 0);
  store.store("b", "other");
  EXPECT_EQ(store.flush(), "");
  EXPECT_EQ(store.load("a"), "first");

  ASSERT_EQ(::mkdir(obstacle.c_str(), 0700), 0);
  store.store("a", "second");
  EXPECT_NE(store.flush(), "");
  ASSERT_EQ(::rmdir(obstacle.c_str()), 0);
  EXPECT_EQ(store.flush(), "");
  EXPECT_EQ(store.load("a"), "second");
}

TEST_F(EepromStoreTest, AFileThatCannotBeReadIsNotTakenForNone) {
  const EepromStore store(folder_);
  fs::create_directory(folder_ + "/a.eeprom");
  EXPECT_THROW((void)store.load("a"), std::runtime_error);
}

TEST_F(EepromStoreTest, OneFolderServesOneProcess) {
  const EepromStore store(folder_);
  try {
    const EepromStore second(folder_);
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_NE(std::string(e.what()).find("is in use by another vinverter"), std::string::npos);
  }
}

TEST(Folders, FollowTheDesktopStandard) {
  ::setenv("XDG_STATE_HOME", "/var/state", 1);
  EXPECT_EQ(default_state_folder("demo"), "/var/state/vinverter/demo");
  ::setenv("XDG_STATE_HOME", "relative", 1);
  ::setenv("HOME", "/home/ann", 1);
  EXPECT_EQ(default_state_folder("demo"), "/home/ann/.local/state/vinverter/demo");
  ::unsetenv("XDG_STATE_HOME");
  EXPECT_EQ(default_state_folder("demo"), "/home/ann/.local/state/vinverter/demo");
  ::setenv("XDG_RUNTIME_DIR", "/run/user/1000", 1);
  EXPECT_EQ(default_runtime_folder("demo"), "/run/user/1000/vinverter/demo");
  ::unsetenv("XDG_RUNTIME_DIR");
  EXPECT_EQ(default_runtime_folder("demo"), "/tmp/vinverter-" + std::to_string(::getuid()) + "/demo");
}

TEST_F(EepromStoreTest, ARuntimeFolderThatOthersCouldUseIsRefused) {
  make_private_folder(folder_ + "/a/b");
  struct stat info {};
  ASSERT_EQ(::stat((folder_ + "/a").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0700u);
  make_private_folder(folder_ + "/a/b");
  ASSERT_EQ(::symlink("/tmp", (folder_ + "/link").c_str()), 0);
  EXPECT_THROW(make_private_folder(folder_ + "/link"), std::runtime_error);
}

}  // namespace
}  // namespace vinv::rig
