#include "pipeline/serve/protocol.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cstring>

#include "host/base/error.hpp"

namespace pvg {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays travel as they lie in memory");

template <class T>
void append(Message& message, const std::string& name, const char* type, const std::vector<std::size_t>& shape,
            std::span<const T> values) {
  message.head["arrays"].push_back(
      {{"name", name}, {"type", type}, {"shape", shape}, {"offset", message.bytes.size()}});
  const auto* first = reinterpret_cast<const unsigned char*>(values.data());
  message.bytes.insert(message.bytes.end(), first, first + values.size_bytes());
}

// How many bytes came before the stream ended.
std::size_t read_bytes(int file, unsigned char* to, std::size_t n) {
  std::size_t done = 0;
  while (done < n) {
    const ssize_t got = read(file, to + done, n - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw Failure(std::string("a request could not be read: ") + std::strerror(errno));
    if (got == 0) break;
    done += std::size_t(got);
  }
  return done;
}

void demand_bytes(int file, unsigned char* to, std::size_t n) {
  if (read_bytes(file, to, n) < n) throw Failure("the stream of requests ended within a message");
}

void write_bytes(int file, const unsigned char* from, std::size_t n) {
  for (std::size_t done = 0; done < n;) {
    const ssize_t written = write(file, from + done, n - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw Failure(std::string("an answer could not be written: ") + std::strerror(errno));
    done += std::size_t(written);
  }
}

}  // namespace

void add_array(Message& message, const std::string& name, const std::vector<std::size_t>& shape,
               std::span<const double> values) {
  append(message, name, "<f8", shape, values);
}
void add_array(Message& message, const std::string& name, const std::vector<std::size_t>& shape,
               std::span<const std::uint8_t> values) {
  append(message, name, "|u1", shape, values);
}
void add_array(Message& message, const std::string& name, const std::vector<std::size_t>& shape,
               std::span<const std::int64_t> values) {
  append(message, name, "<i8", shape, values);
}

std::optional<Message> read_message(int file) {
  std::array<std::uint32_t, 2> lengths{};
  auto* header = reinterpret_cast<unsigned char*>(lengths.data());
  const std::size_t got = read_bytes(file, header, sizeof lengths);
  if (got == 0) return std::nullopt;
  if (got < sizeof lengths) throw Failure("the stream of requests ended within a message");
  if (lengths[0] > LARGEST_HEAD || lengths[1] > LARGEST_ARRAYS)
    throw Failure("a message of " + std::to_string(lengths[0]) + " and " + std::to_string(lengths[1]) +
                  " bytes is longer than any; is the client's protocol this one?");
  std::string head(lengths[0], '\0');
  demand_bytes(file, reinterpret_cast<unsigned char*>(head.data()), head.size());
  Message message;
  message.bytes.resize(lengths[1]);
  demand_bytes(file, message.bytes.data(), message.bytes.size());
  message.head = nlohmann::ordered_json::parse(head, nullptr, false);
  if (!message.head.is_object()) throw UsageError("the head of a request is no JSON object");
  return message;
}

void write_message(int file, const Message& message) {
  // words of a request are cut where they are long, also within a character
  const std::string head = message.head.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  const std::array<std::uint32_t, 2> lengths = {std::uint32_t(head.size()), std::uint32_t(message.bytes.size())};
  write_bytes(file, reinterpret_cast<const unsigned char*>(lengths.data()), sizeof lengths);
  write_bytes(file, reinterpret_cast<const unsigned char*>(head.data()), head.size());
  write_bytes(file, message.bytes.data(), message.bytes.size());
}

void serve_stream(const Message& greeting, const std::function<Message(const Message&)>& answer, int from, int to) {
  write_message(to, greeting);
  while (true) {
    std::optional<Message> request;
    try {
      request = read_message(from);
    } catch (const UsageError& error) {
      Message refused;
      refused.head["error"] = error.what();
      write_message(to, refused);
      continue;
    }
    if (!request) return;
    write_message(to, answer(*request));
    if (request->head.value("do", nlohmann::ordered_json()) == "close") return;
  }
}

}  // namespace pvg
