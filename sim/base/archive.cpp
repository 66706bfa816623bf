#include "sim/base/archive.hpp"

#include <algorithm>
#include <cstdio>

#include "sim/base/check.hpp"

namespace vinv {
namespace {

constexpr std::array<std::uint8_t, 8> kMagic{'V', 'I', 'N', 'V', 'S', 'N', 'A', 'P'};
// Offsets in the header: magic, version and 4 bytes of zero, length of what follows, its checksum.
constexpr std::size_t kVersionAt = 8;
constexpr std::size_t kReservedAt = 12;
constexpr std::size_t kLengthAt = 16;
constexpr std::size_t kChecksumAt = 24;

constexpr std::size_t kFirstRoom = 4096;
static_assert(kFirstRoom >= kSnapshotHeader);

template <class T>
T word_at(ByteView bytes, std::size_t at) {
  T word;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

}  // namespace

std::uint64_t snapshot_checksum(ByteView bytes) {
  // Each step is one-to-one in the state, so two inputs that differ in one word never meet again.
  std::uint64_t hash = 0x9e3779b97f4a7c15ULL ^ bytes.size();
  const auto mix = [&hash](std::uint64_t word) {
    hash = (hash ^ word) * 0xff51afd7ed558ccdULL;
    hash ^= hash >> 32;
  };
  std::size_t at = 0;
  for (; at + 8 <= bytes.size(); at += 8) mix(word_at<std::uint64_t>(bytes, at));
  std::uint64_t tail = 0;
  if (at < bytes.size()) std::memcpy(&tail, bytes.data() + at, bytes.size() - at);
  mix(tail);
  mix(0);
  return hash;
}

void seal_snapshot(Bytes& snapshot) {
  VINV_CHECK(snapshot.size() >= kSnapshotHeader);
  const std::uint64_t length = snapshot.size() - kSnapshotHeader;
  const std::uint64_t checksum = snapshot_checksum(ByteView(snapshot).subspan(kSnapshotHeader));
  std::memcpy(snapshot.data() + kLengthAt, &length, sizeof length);
  std::memcpy(snapshot.data() + kChecksumAt, &checksum, sizeof checksum);
}

Archive Archive::saving(Bytes& out) {
  Archive a(Mode::kSave);
  a.out_ = &out;
  a.at_ = kSnapshotHeader;
  out.resize(std::max(out.capacity(), kFirstRoom));
  std::fill_n(out.begin(), kSnapshotHeader, std::uint8_t{0});
  std::copy(kMagic.begin(), kMagic.end(), out.begin());
  std::memcpy(out.data() + kVersionAt, &kSnapshotVersion, sizeof kSnapshotVersion);
  return a;
}

Archive Archive::loading(ByteView snapshot) {
  Archive a(Mode::kLoad);
  if (snapshot.size() < kSnapshotHeader || !std::equal(kMagic.begin(), kMagic.end(), snapshot.begin())) {
    a.fail("these bytes are not a snapshot");
    return a;
  }
  const auto version = word_at<std::uint32_t>(snapshot, kVersionAt);
  if (version != kSnapshotVersion) {
    a.fail("the snapshot has format " + std::to_string(version) + ", this program reads format " +
           std::to_string(kSnapshotVersion));
    return a;
  }
  const ByteView payload = snapshot.subspan(kSnapshotHeader);
  const auto length = word_at<std::uint64_t>(snapshot, kLengthAt);
  if (length != payload.size()) {
    a.fail("the snapshot is damaged: " + std::to_string(payload.size()) + " bytes where " + std::to_string(length) +
           " were written");
    return a;
  }
  if (word_at<std::uint32_t>(snapshot, kReservedAt) != 0 ||
      word_at<std::uint64_t>(snapshot, kChecksumAt) != snapshot_checksum(payload)) {
    a.fail("the snapshot is damaged: its checksum does not fit");
    return a;
  }
  a.in_ = payload;
  return a;
}

Archive Archive::listing(std::string& out) {
  Archive a(Mode::kList);
  a.list_ = &out;
  return a;
}

void Archive::fail(std::string why) {
  if (failed()) return;
  error_ = why.empty() ? "the snapshot is refused" : std::move(why);
}

void Archive::seal() {
  if (failed()) return;
  if (mode_ == Mode::kSave) {
    out_->resize(at_);
    seal_snapshot(*out_);
  }
  require(at_ == in_.size(), "it has more values than this build reads");
}

void Archive::block_with_checks(void* data, std::size_t size) {
  if (failed() || size == 0) return;
  switch (mode_) {
    case Mode::kSave:
      out_->resize(std::max(2 * out_->size(), at_ + size));
      std::memcpy(out_->data() + at_, data, size);
      at_ += size;
      return;
    case Mode::kLoad:
      if (size > in_.size() - at_) {
        fail("the snapshot is damaged: it ends too early");
        return;
      }
      std::memcpy(data, in_.data() + at_, size);
      at_ += size;
      return;
    case Mode::kList: {
      std::string text;
      constexpr char kDigits[] = "0123456789abcdef";
      const auto* bytes = static_cast<const std::uint8_t*>(data);
      for (std::size_t i = 0; i < size; ++i) (text += kDigits[bytes[i] >> 4]) += kDigits[bytes[i] & 15];
      list(text);
      return;
    }
  }
}

std::size_t Archive::count(std::size_t here, std::size_t limit) {
  std::uint64_t n = here;
  io(n);
  if (failed()) return 0;
  VINV_CHECK(loads() || n <= limit);
  require(n <= limit, "a list is longer than there can be");
  return failed() ? 0 : static_cast<std::size_t>(n);
}

void Archive::must_match(std::string_view what, std::string_view here) {
  std::string there(here);
  io(there);
  if (loads() && there != here) {
    fail("the snapshot is of another " + std::string(what) + ": " + there + ", not " + std::string(here));
  }
}

void Archive::must_match(std::string_view what, std::uint64_t here) {
  std::uint64_t there = here;
  io(there);
  if (loads() && there != here) fail("the snapshot is of another " + std::string(what));
}

bool Archive::check_layout(std::string_view type, std::uint32_t layout) {
  if (failed()) return false;
  std::uint32_t there = layout;
  block(&there, sizeof there);
  if (loads() && there != layout) {
    fail("the snapshot is of another build: " + std::string(type) + " has other fields there");
  }
  return !failed();
}

void Archive::list(std::string_view value) { list_->append(path_).append(" = ").append(value).append("\n"); }

void Archive::list_real(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  list(text);
}

void archive(Archive& a, std::string& text) {
  const std::size_t size = a.count(text.size());
  if (a.loads()) {
    a.require(size <= a.left(), "a text is longer than what is left");
    if (a.failed()) return;
    text.resize(size);
  }
  a.block(text.data(), size);
}

}  // namespace vinv
