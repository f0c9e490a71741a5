// Answers requests about one task, of which several worlds may step together, message by message
// (docs/reference/serve.md).
#pragma once
#include <string>

#include "pipeline/serve/protocol.hpp"
#include "pipeline/serve/served_task.hpp"

namespace pvg {

// The first message of a stream: what holds for every episode. program: its version.
Message greeting(const ServedWorlds& worlds, const std::string& program);

// The answer to one request. What is wrong with a request is an answer with the key `error`, one sentence; nothing is
// lost by it. Other failures are thrown.
Message answer(ServedWorlds& worlds, const Message& request);

// Greets, then answers until the stream of requests ends or one asks to close. A Failure where a stream breaks off.
void serve_stream(ServedWorlds& worlds, const std::string& program, int from, int to);

}  // namespace pvg
