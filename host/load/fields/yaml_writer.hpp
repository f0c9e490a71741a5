// Writes a configuration as YAML, with every digit that a number has.
#pragma once
#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "host/model/task.hpp"

namespace pvg {

class YamlWriter {
 public:
  explicit YamlWriter(std::filesystem::path folder) : folder_(std::move(folder)) {  // paths are relative to it
    out_.SetDoublePrecision(17);
    out_.SetFloatPrecision(9);
    out_ << YAML::BeginMap;
  }
  template <typename T>
  void entry(const std::string& key, const T& value) {
    out_ << YAML::Key << key << YAML::Value << value;
  }
  void path(const std::string& key, const std::filesystem::path& file) {  // an empty one is left out
    if (!file.empty()) entry(key, file.lexically_relative(folder_).generic_string());
  }
  void paths(const std::string& key, const std::vector<std::filesystem::path>& files) {
    std::vector<std::string> relative;
    for (const auto& file : files) relative.push_back(file.lexically_relative(folder_).generic_string());
    flow(key, relative);
  }
  template <typename T>
  void flow(const std::string& key, const std::vector<T>& list) {  // in one line
    out_ << YAML::Key << key << YAML::Value << YAML::Flow << list;
  }
  template <typename Vector>
  void vector(const std::string& key, const Vector& v) {
    out_ << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginSeq;
    for (Eigen::Index i = 0; i < v.size(); ++i) out_ << v[i];
    out_ << YAML::EndSeq;
  }
  void range(const std::string& key, const Range& range) {
    if (range.low == range.high) return entry(key, range.low);
    out_ << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginSeq << range.low << range.high << YAML::EndSeq;
  }
  void pose(const std::string& key, const Pose& pose) {
    begin(key);
    vector("position", Vec3(pose.translation()));
    vector("quaternion", Eigen::Quaterniond(pose.linear()).coeffs());  // x, y, z, w
    end();
  }
  void begin(const std::string& key) { out_ << YAML::Key << key << YAML::Value << YAML::BeginMap; }
  void end() { out_ << YAML::EndMap; }
  template <typename List, typename Write>
  void list(const std::string& key, const List& list, Write write) {
    out_ << YAML::Key << key << YAML::Value << YAML::BeginSeq;
    for (const auto& item : list) {
      out_ << YAML::BeginMap;
      write(item);
      out_ << YAML::EndMap;
    }
    out_ << YAML::EndSeq;
  }
  std::string finish() {
    out_ << YAML::EndMap;
    return std::string(out_.c_str()) + "\n";
  }

 private:
  YAML::Emitter out_;
  std::filesystem::path folder_;
};

}  // namespace pvg
