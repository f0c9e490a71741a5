// The messages of `phyvisgen serve`, the same in both directions: a head in JSON, then the bytes of the arrays that the
// head names. docs/reference/serve.md holds the whole protocol.
//
//   u32 little-endian   n, bytes of the head
//   u32 little-endian   m, bytes of the arrays
//   n bytes             head: a JSON object in UTF-8
//   m bytes             arrays, one after the other: "arrays" in the head has name, type, shape and offset of each
#pragma once
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace pvg {

inline constexpr int PROTOCOL_VERSION = 1;
inline constexpr std::uint32_t LARGEST_HEAD = 1 << 24, LARGEST_ARRAYS = 1u << 30;  // that are read [bytes]

struct Message {
  nlohmann::ordered_json head = nlohmann::ordered_json::object();
  std::vector<unsigned char> bytes;  // of the arrays
};

// Adds an array to a message. values: row by row; shape: its sizes, whose product is their number.
void add_array(Message& message, const std::string& name, const std::vector<std::size_t>& shape,
               std::span<const double> values);  // <f8
void add_array(Message& message, const std::string& name, const std::vector<std::size_t>& shape,
               std::span<const std::uint8_t> values);  // |u1
void add_array(Message& message, const std::string& name, const std::vector<std::size_t>& shape,
               std::span<const std::int64_t> values);  // <i8

// The next message; nothing at the end of the stream. A Failure where the stream ends within a message or a length is
// beyond the limits: what follows cannot be read. A head that is no JSON object is a UsageError, and the stream goes
// on.
std::optional<Message> read_message(int file);

// A Failure where nobody reads any more.
void write_message(int file, const Message& message);

// Greets, then answers until the stream of requests ends or one asks to close. A Failure where a stream breaks off.
void serve_stream(const Message& greeting, const std::function<Message(const Message&)>& answer, int from, int to);

}  // namespace pvg
