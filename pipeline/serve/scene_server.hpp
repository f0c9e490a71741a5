// Answers requests about one scene, message by message (docs/reference/serve.md).
#pragma once
#include <string>

#include "pipeline/serve/protocol.hpp"
#include "pipeline/serve/served_scene.hpp"

namespace pvg {

// The first message of a stream: what never changes. program: its version.
Message greeting(const ServedScene& scene, const std::string& program);

// The answer to one request. What is wrong with a request, and a step that cannot be done, is an answer with the key
// `error`, one sentence; nothing is lost by it. Other failures are thrown.
Message answer(ServedScene& scene, const Message& request);

}  // namespace pvg
