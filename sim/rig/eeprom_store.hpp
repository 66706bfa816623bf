// EEPROM files of a live plant: one per drive in the plant's state folder, FOLDER/DRIVE.eeprom, and FOLDER/DRIVE.flash
// for the memory of an option board. Written whole by temporary file, fsync and rename on a thread of their own. A
// damaged file is kept aside as DRIVE.eeprom.damaged-N.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>

namespace vinv::rig {

enum class Memory : std::uint8_t { kEeprom, kFlash };

class EepromStore {
 public:
  // Makes the folder and locks it, so that two processes never write the same files. Throws std::runtime_error with a
  // sentence for a person if it cannot.
  explicit EepromStore(std::string folder);
  // Writes what is still queued.
  ~EepromStore();
  EepromStore(const EepromStore&) = delete;
  EepromStore& operator=(const EepromStore&) = delete;

  const std::string& folder() const { return folder_; }
  std::string path(const std::string& drive, Memory memory = Memory::kEeprom) const {
    return folder_ + "/" + file_name(drive, memory);
  }

  // Empty if there is no file. Throws if there is one that cannot be read.
  std::optional<std::string> load(const std::string& drive, Memory memory = Memory::kEeprom) const;
  // Moves the file to the first free name with .damaged-N behind and returns that path. Throws if it cannot.
  std::string keep_aside(const std::string& drive, Memory memory = Memory::kEeprom) const;
  // Queues the text for writing; a newer text of the same file takes the place of one that waits. What could not be
  // written is tried again with the next text of any drive, and by flush().
  void store(const std::string& drive, std::string text, Memory memory = Memory::kEeprom);
  // Waits until everything queued is written. Returns the first failure since the last call, a sentence, or nothing.
  std::string flush();
  // The first failure since the last call, without waiting.
  std::string take_failure();

 private:
  static std::string file_name(const std::string& drive, Memory memory) {
    return drive + (memory == Memory::kEeprom ? ".eeprom" : ".flash");
  }
  void write_queued();
  void queue_failed();

  std::string folder_;
  int lock_ = -1;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, std::string> queued_;  // file name, text
  std::map<std::string, std::string> failed_;  // could not be written
  bool writing_ = false;
  bool stopping_ = false;
  std::string failure_;
  std::thread writer_;
};

// kNo: for what can be made again; after a crash of the machine the file may be the old one, or empty.
enum class FileSync : std::uint8_t { kNo, kYes };
// Writes the whole text or nothing: temporary file beside it, fsync, rename, fsync of the folder. Throws
// std::runtime_error with the path and the reason, and removes the temporary file.
void write_whole_file(const std::string& path, std::string_view text, FileSync sync = FileSync::kYes);

}  // namespace vinv::rig
