// Snapshots: one function per type that saves or loads, as the archive says (docs/decisions/0005-snapshots.md).
//
//   class Lag {
//    private:
//     double value_ = 0;
//     VINV_ARCHIVE(Lag, value_);  // all members, in their order: one forgotten or added does not compile
//   };
//   const Bytes bytes = save_snapshot(plant);
//   const auto ok = load_snapshot(other_plant, bytes);  // refused: other_plant is what it was
//
// The bytes: magic, format version, length, checksum, then the values of the fields. Before the values of each struct
// stands a hash of its name, its fields' names and their types, so that a snapshot of a build with other fields is
// refused by name. Snapshots serve the build that wrote them; what is kept for long is text (EEPROM files).
// An archive that has failed reads and writes nothing more and keeps its first reason.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "sim/base/bytes.hpp"
#include "sim/base/result.hpp"
#include "sim/base/time.hpp"

namespace vinv {

inline constexpr std::uint32_t kSnapshotVersion = 1;
inline constexpr std::size_t kSnapshotHeader = 32;

// Values that an enumeration may have; one that is archived has a function enum_range next to it (VINV_ENUM_RANGE).
template <class E>
struct EnumRange {
  E first;
  E last;
};

template <class T>
constexpr std::uint32_t type_code();

class Archive {
 public:
  // Begins a snapshot in out, whose capacity is reused; seal() ends it.
  static Archive saving(Bytes& out);
  // Checks magic, version, length and checksum; the archive may have failed already. The bytes outlive the archive.
  static Archive loading(ByteView snapshot);
  // Writes one line per value ("DriveCore.ramp_.frequency_hz_ = 12.5"), for people and for comparing two states.
  static Archive listing(std::string& out);

  bool loads() const { return mode_ == Mode::kLoad; }
  bool failed() const { return !error_.empty(); }
  // A sentence for a person; empty if all is well.
  const std::string& error() const { return error_; }
  void fail(std::string why);
  // While loading: a value from outside that has to hold before anything relies on it.
  void require(bool condition, std::string_view what) {
    if (loads() && !condition) fail("the snapshot is damaged: " + std::string(what));
  }
  // Saving: length and checksum. Loading: nothing may be left over.
  void seal();

  // Any value that has an archive function, numbers and enumerations.
  template <class T>
  void io(T& value);
  // Constants that saver and loader must share, because they are not part of the state: what says in which words.
  void must_match(std::string_view what, std::string_view here);
  void must_match(std::string_view what, std::uint64_t here);
  // Number of elements of a container, for loops of one's own: 0 once failed. Loading refuses more than limit.
  std::size_t count(std::size_t here, std::size_t limit = kMostElements);
  // Raw bytes, for contiguous numbers.
  void block(void* data, std::size_t size) {
    // What nearly every call comes to.
    if (mode_ == Mode::kSave && out_->size() - at_ >= size && !failed()) {
      std::memcpy(out_->data() + at_, data, size);
      at_ += size;
    } else {
      block_with_checks(data, size);
    }
  }
  // Bytes that a load has still to read.
  std::size_t left() const { return mode_ == Mode::kLoad ? in_.size() - at_ : 0; }

  // Use the macros.
  template <std::uint32_t kNamesHash, class... T>
  void fields(std::string_view type, std::string_view names, T&... values);

  static constexpr std::size_t kMostElements = std::size_t{1} << 24;

 private:
  enum class Mode : std::uint8_t { kSave, kLoad, kList };
  explicit Archive(Mode mode) : mode_(mode) {}

  void block_with_checks(void* data, std::size_t size);
  bool check_layout(std::string_view type, std::uint32_t layout);
  void list(std::string_view value);
  void list_real(double value);
  template <class T>
  void number(T& value);
  void enter(std::string_view part) { path_.append(path_.empty() ? 0 : 1, '.').append(part); }

  Mode mode_;
  Bytes* out_ = nullptr;  // saving: longer than what is written, until seal()
  ByteView in_;
  std::size_t at_ = 0;
  std::string* list_ = nullptr;
  std::string path_;  // of a listing
  std::string error_;
};

constexpr std::uint32_t layout_hash(std::string_view text, std::uint32_t hash = 2166136261u) {
  for (const char c : text) hash = (hash ^ static_cast<std::uint8_t>(c)) * 16777619u;
  return hash;
}

// 64 bits over the bytes; every change within eight of them changes it.
std::uint64_t snapshot_checksum(ByteView bytes);
// Writes length and checksum of what follows the header into it.
void seal_snapshot(Bytes& snapshot);

// NOLINTBEGIN(cppcoreguidelines-macro-usage): names of fields as text, and a friend that sees private members
// In the class, last: a friend function that archives it. Every member must be named, in order of declaration.
#define VINV_ARCHIVE(Type, ...)                                           \
  friend void archive(::vinv::Archive& vinv_archive, Type& vinv_object) { \
    VINV_MEMBERS(vinv_object, __VA_ARGS__);                               \
    VINV_FIELDS(vinv_archive, Type, __VA_ARGS__);                         \
  }                                                                       \
  static_assert(true)
// Names all members of an object, for functions that archive only some of them.
#define VINV_MEMBERS(object, ...)                                                                               \
  _Pragma("GCC diagnostic push") _Pragma("GCC diagnostic ignored \"-Wshadow\"") auto& [__VA_ARGS__] = (object); \
  _Pragma("GCC diagnostic pop") static_assert(true)
// Lvalues by name: the archive, a name for the group, the values.
#define VINV_FIELDS(the_archive, Type, ...) \
  (the_archive).template fields<::vinv::layout_hash(#Type "(" #__VA_ARGS__ ")")>(#Type, #__VA_ARGS__, __VA_ARGS__)
// Next to the enumeration: first and last enumerator; in a class with "friend" before it.
#define VINV_ENUM_RANGE(Enum, first, last)                                                 \
  constexpr ::vinv::EnumRange<Enum> enum_range(Enum) { return {Enum::first, Enum::last}; } \
  static_assert(true)
// NOLINTEND(cppcoreguidelines-macro-usage)

// --- values of the standard library ---

void archive(Archive& a, std::string& text);

inline void archive(Archive& a, Duration& d) {
  std::int64_t ns = d.count();
  a.io(ns);
  d = Duration{ns};
}
inline void archive(Archive& a, Instant& t) {
  std::int64_t ns = to_ns(t);
  a.io(ns);
  t = instant_from_ns(ns);
}

template <class T>
void archive(Archive& a, std::optional<T>& value) {
  bool present = value.has_value();
  a.io(present);
  if (a.loads() && present && !value) value.emplace(T{});
  if (!present) {
    value.reset();
  } else {
    a.io(*value);
  }
}

template <class A, class B>
void archive(Archive& a, std::pair<A, B>& value) {
  a.io(value.first);
  a.io(value.second);
}

// T and E are values that can be made from nothing.
template <class T, class E>
void archive(Archive& a, Result<T, E>& result) {
  bool ok = result.has_value();
  a.io(ok);
  T value = !a.loads() && ok ? *result : T{};
  E error = !a.loads() && !ok ? result.error() : E{};
  if (ok) {
    a.io(value);
  } else {
    a.io(error);
  }
  if (a.loads()) result = ok ? Result<T, E>(std::move(value)) : Result<T, E>(Unexpected(std::move(error)));
}

template <class T, class E>
void archive(Archive& a, std::optional<Result<T, E>>& value) {
  bool present = value.has_value();
  a.io(present);
  if (a.loads() && present) value.emplace(Unexpected(E{}));
  if (!present) {
    value.reset();
  } else {
    a.io(*value);
  }
}

template <class E>
void archive(Archive& a, Result<void, E>& result) {
  bool ok = result.has_value();
  E error = ok ? E{} : result.error();
  a.io(ok);
  if (!ok) a.io(error);
  if (a.loads()) result = ok ? Result<void, E>() : Result<void, E>(Unexpected(error));
}

template <class T, std::size_t kSize>
void archive(Archive& a, std::array<T, kSize>& values) {
  for (T& value : values) a.io(value);
}

template <class T, class Allocator>
void archive(Archive& a, std::vector<T, Allocator>& values) {
  static_assert(!std::is_same_v<T, bool>);
  const std::size_t count = a.count(values.size());
  if constexpr (std::is_arithmetic_v<T>) {
    if (a.loads()) {
      a.require(count <= a.left() / sizeof(T), "a list is longer than what is left");
      if (a.failed()) return;
      values.resize(count);
    }
    if (count == 0) return;
    a.block(values.data(), count * sizeof(T));
  } else {
    if (a.loads()) values.clear();
    for (std::size_t i = 0; i < count && !a.failed(); ++i) {
      if (a.loads()) values.emplace_back();
      a.io(values[i]);
    }
  }
}

template <class T>
void archive(Archive& a, std::deque<T>& values) {
  const std::size_t count = a.count(values.size());
  if (a.loads()) values.clear();
  for (std::size_t i = 0; i < count && !a.failed(); ++i) {
    if (a.loads()) values.emplace_back();
    a.io(values[i]);
  }
}

template <class Key, class T, class Compare>
void archive(Archive& a, std::map<Key, T, Compare>& values) {
  const std::size_t count = a.count(values.size());
  if (!a.loads()) {
    for (auto& [key, value] : values) {
      Key copy = key;
      a.io(copy);
      a.io(value);
    }
    return;
  }
  values.clear();
  for (std::size_t i = 0; i < count && !a.failed(); ++i) {
    Key key{};
    a.io(key);
    a.io(values[key]);
  }
}

// --- whole objects ---

// Of one build: the bytes of equal states are equal. out keeps its capacity, for many snapshots.
template <class T>
void save_snapshot(T& object, Bytes& out) {
  Archive a = Archive::saving(out);
  a.io(object);
  a.seal();
  VINV_CHECK(!a.failed());
}

template <class T>
Bytes save_snapshot(T& object) {
  Bytes out;
  save_snapshot(object, out);
  return out;
}

// All or nothing: an object that refuses the bytes gets back what it was.
template <class T>
Result<void, std::string> load_snapshot(T& object, ByteView snapshot) {
  Archive a = Archive::loading(snapshot);
  if (a.failed()) return Unexpected(a.error());
  const Bytes before = save_snapshot(object);
  a.io(object);
  a.seal();
  if (!a.failed()) return {};
  Archive back = Archive::loading(before);
  back.io(object);
  VINV_CHECK(!back.failed());
  return Unexpected(a.error());
}

// The state as text, a line per value.
template <class T>
std::string list_snapshot(T& object) {
  std::string out;
  Archive a = Archive::listing(out);
  a.io(object);
  return out;
}

// --- details ---

template <class T>
constexpr std::uint32_t type_code() {
  constexpr auto size = static_cast<std::uint32_t>(sizeof(T));
  if constexpr (std::is_same_v<T, bool>) return 1;
  if constexpr (std::is_enum_v<T>) return 0x100 + size;
  if constexpr (std::is_floating_point_v<T>) return 0x200 + size;
  if constexpr (std::is_integral_v<T>) return (std::is_signed_v<T> ? 0x300 : 0x400) + size;
  if constexpr (requires { typename T::value_type; }) return 0x500 + 31 * type_code<typename T::value_type>();
  return 0x600;
}

template <class T>
void Archive::number(T& value) {
  static_assert(std::endian::native == std::endian::little, "snapshots are little-endian memory");
  if (mode_ == Mode::kList) {
    if constexpr (std::is_floating_point_v<T>) {
      list_real(static_cast<double>(value));
    } else {
      list(std::to_string(value));
    }
    return;
  }
  block(&value, sizeof value);
}

template <class T>
void Archive::io(T& value) {
  static_assert(!std::is_const_v<T> && !std::is_pointer_v<T>);
  if constexpr (std::is_same_v<T, bool>) {
    std::uint8_t byte = value ? 1 : 0;
    number(byte);
    require(byte <= 1, "a truth value is neither");
    value = byte != 0;
  } else if constexpr (std::is_enum_v<T>) {
    auto raw = static_cast<std::underlying_type_t<T>>(value);
    number(raw);
    constexpr auto range = enum_range(T{});
    const bool known = raw >= static_cast<std::underlying_type_t<T>>(range.first) &&
                       raw <= static_cast<std::underlying_type_t<T>>(range.last);
    require(known, "an enumeration has a value that it does not know");
    if (known) value = static_cast<T>(raw);
  } else if constexpr (std::is_arithmetic_v<T>) {
    number(value);
  } else {
    archive(*this, value);
  }
}

template <std::uint32_t kNamesHash, class... T>
void Archive::fields(std::string_view type, std::string_view names, T&... values) {
  if (mode_ == Mode::kList) {
    const std::size_t length = path_.size();
    if (length == 0) enter(type);
    const auto one = [&](auto& value) {
      const std::size_t comma = names.find(',');
      const std::size_t end = comma == std::string_view::npos ? names.size() : comma;
      const std::size_t outer = path_.size();
      enter(names.substr(0, end));
      names.remove_prefix(end);
      while (names.starts_with(',') || names.starts_with(' ')) names.remove_prefix(1);
      io(value);
      path_.resize(outer);
    };
    (one(values), ...);
    path_.resize(length);
    return;
  }
  constexpr std::uint32_t layout = [] {
    std::uint32_t hash = kNamesHash;
    ((hash = (hash ^ type_code<T>()) * 16777619u), ...);
    return hash;
  }();
  if (!check_layout(type, layout)) return;
  (io(values), ...);
}

}  // namespace vinv
