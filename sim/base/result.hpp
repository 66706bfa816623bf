// Result<T, E>: a value or the reason why there is none. Members are named like std::expected's, which g++ 12 lacks.
#pragma once

#include <type_traits>
#include <utility>
#include <variant>

#include "sim/base/check.hpp"

namespace vinv {

template <class E>
class Unexpected {
 public:
  constexpr explicit Unexpected(E error) : error_(std::move(error)) {}
  constexpr const E& error() const& { return error_; }
  constexpr E&& error() && { return std::move(error_); }

 private:
  E error_;
};

template <class E>
Unexpected(E) -> Unexpected<E>;

template <class T, class E>
class [[nodiscard]] Result {
 public:
  constexpr Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  template <class G, class = std::enable_if_t<std::is_convertible_v<G, E>>>
  constexpr Result(Unexpected<G> u) : state_(std::in_place_index<1>, std::move(u).error()) {}

  constexpr bool has_value() const { return state_.index() == 0; }
  constexpr explicit operator bool() const { return has_value(); }
  constexpr const T& value() const& { return VINV_CHECK(has_value()), std::get<0>(state_); }
  constexpr T& value() & { return VINV_CHECK(has_value()), std::get<0>(state_); }
  constexpr T&& value() && { return VINV_CHECK(has_value()), std::get<0>(std::move(state_)); }
  constexpr const T& operator*() const& { return value(); }
  constexpr T& operator*() & { return value(); }
  constexpr T&& operator*() && { return std::move(*this).value(); }
  constexpr const T* operator->() const { return &value(); }
  constexpr T* operator->() { return &value(); }
  constexpr const E& error() const { return VINV_CHECK(!has_value()), std::get<1>(state_); }
  template <class U>
  constexpr T value_or(U&& fallback) const& {
    return has_value() ? std::get<0>(state_) : static_cast<T>(std::forward<U>(fallback));
  }

 private:
  std::variant<T, E> state_;
};

template <class E>
class [[nodiscard]] Result<void, E> {
 public:
  constexpr Result() = default;
  template <class G, class = std::enable_if_t<std::is_convertible_v<G, E>>>
  constexpr Result(Unexpected<G> u) : error_(std::in_place_index<1>, std::move(u).error()) {}

  constexpr bool has_value() const { return error_.index() == 0; }
  constexpr explicit operator bool() const { return has_value(); }
  constexpr const E& error() const { return VINV_CHECK(!has_value()), std::get<1>(error_); }

 private:
  std::variant<std::monostate, E> error_;
};

}  // namespace vinv
