// Errors as values: the library never exits, prints or throws across its border.
//
// A function that can fail for reasons outside the program (a file, a model, the disk) returns a
// Result. Broken preconditions are asserts.
#pragma once

#include <cassert>
#include <string>
#include <utility>
#include <variant>

namespace sightline {

/// What kind of failure it was: decides the exit status of a program (see exit_status()).
enum class ErrorKind {
    bad_option,  ///< the caller asked for something that can't be (exit status 2)
    bad_input,   ///< a file or model can't be used (exit status 1)
    io,          ///< the system refused: disk, memory, permissions (exit status 1)
    cancelled,   ///< stopped on request or by a time limit (exit status 1)
};

/// One failure. `message` is one line that names the file or option, the cause and the way out.
struct Error {
    ErrorKind kind = ErrorKind::bad_input;
    std::string message;
};

/// 2 for wrong use, 1 for a failed job.
[[nodiscard]] constexpr int exit_status(ErrorKind kind) {
    return kind == ErrorKind::bad_option ? 2 : 1;
}

/// Either a T or the Error that prevented it.
template <class T>
class [[nodiscard]] Result {
public:
    Result(T value) : state_(std::move(value)) {}
    Result(Error error) : state_(std::move(error)) {}

    [[nodiscard]] bool ok() const { return std::holds_alternative<T>(state_); }
    explicit operator bool() const { return ok(); }

    [[nodiscard]] T& value() & {
        assert(ok());
        return *std::get_if<T>(&state_);
    }
    [[nodiscard]] const T& value() const& {
        assert(ok());
        return *std::get_if<T>(&state_);
    }
    [[nodiscard]] T&& value() && {
        assert(ok());
        return std::move(*std::get_if<T>(&state_));
    }
    [[nodiscard]] T& operator*() & { return value(); }
    [[nodiscard]] const T& operator*() const& { return value(); }
    [[nodiscard]] T* operator->() { return &value(); }
    [[nodiscard]] const T* operator->() const { return &value(); }

    [[nodiscard]] const Error& error() const {
        assert(!ok());
        return *std::get_if<Error>(&state_);
    }

private:
    std::variant<T, Error> state_;
};

/// A Result without a value.
using Status = Result<std::monostate>;

/// The successful Status.
[[nodiscard]] inline Status success() { return std::monostate{}; }

}  // namespace sightline
