#include "host/dataset/truth_file.hpp"

#include <algorithm>

namespace pvg {

MaskLabels mask_labels(const Scene& scene, const std::filesystem::path& file) {
  MaskLabels labels{{"nothing"}, {"nothing"}, {0}};
  for (const Visual& visual : scene.visuals) {
    const std::string part = visual.part.empty() ? "other" : visual.part;
    auto found = std::find(labels.parts.begin(), labels.parts.end(), part);
    if (found == labels.parts.end()) found = labels.parts.insert(labels.parts.end(), part);
    labels.part_of_instance.push_back(std::uint8_t(found - labels.parts.begin()));
    labels.instances.push_back(visual.name);
  }
  if (labels.parts.size() > 256 || labels.instances.size() > 65536)
    throw UsageError(file.string() + ": a mask has room for 255 parts and 65535 visuals");
  return labels;
}

std::vector<InstanceBox> instance_boxes(std::span<const std::uint32_t> instance, int width, std::size_t n_instances) {
  std::vector<InstanceBox> boxes(n_instances);
  for (std::size_t i = 0; i < instance.size(); ++i) {
    if (instance[i] == 0) continue;
    InstanceBox& box = boxes.at(instance[i] - 1);
    const std::int32_t x = std::int32_t(i % std::size_t(width)), y = std::int32_t(i / std::size_t(width));
    auto& [x0, y0, x1, y1] = box.corners;
    if (box.visible++ == 0) {
      box.corners = {x, y, x, y};
      continue;
    }
    x0 = std::min(x0, x);
    y0 = std::min(y0, y);
    x1 = std::max(x1, x);
    y1 = std::max(y1, y);
  }
  return boxes;
}

struct TruthFile::Impl {
  template <class T>
  using Series = hdf5::Series<T>;
  Impl(const std::filesystem::path& path, const Scene& scene_, const Camera& camera)
      : scene(scene_),
        labels(mask_labels(scene, path)),
        height(std::uint64_t(camera.height)),
        width(std::uint64_t(camera.width)),
        n(scene.visuals.size()),
        file(hdf5::File::create(path)) {}

  template <class T>
  void put(std::unique_ptr<Series<T>>& series, const std::vector<T>& values) {
    series->append(values);
  }

  const Scene& scene;
  MaskLabels labels;
  std::uint64_t height, width, n;
  hdf5::File file;
  hdf5::Shape pixels{height, width}, vectors{height, width, 3}, flows{height, width, 2};
  // the series must be closed before their file
  std::unique_ptr<Series<float>> depth = series<float>("/depth", pixels), distance = series<float>("/distance", pixels),
                                 normal = series<float>("/normal", vectors), albedo = series<float>("/albedo", vectors),
                                 mean_normal = series<float>("/mean_normal", vectors),
                                 forward = series<float>("/flow_forward", flows),
                                 backward = series<float>("/flow_backward", flows);
  std::unique_ptr<Series<std::uint16_t>> instance = series<std::uint16_t>("/instance", pixels);
  std::unique_ptr<Series<std::uint8_t>> part = series<std::uint8_t>("/part", pixels),
                                        forward_state = series<std::uint8_t>("/flow_forward_state", pixels),
                                        backward_state = series<std::uint8_t>("/flow_backward_state", pixels);
  std::unique_ptr<Series<std::int32_t>> box = series<std::int32_t>("/box", {n, 4});
  std::unique_ptr<Series<std::int64_t>> visible = series<std::int64_t>("/visible", {n});
  std::unique_ptr<Series<double>> pose = series<double>("/pose", {n, 3, 4}),
                                  camera_pose = series<double>("/T_world_camera", {4, 4}),
                                  time = series<double>("/time", {});

 private:
  template <class T>
  std::unique_ptr<Series<T>> series(const std::string& name, const hdf5::Shape& row) {
    return std::make_unique<Series<T>>(file, name, row, row.size() > 1 && row[0] == height);
  }
};

TruthFile::TruthFile(const std::filesystem::path& path, const Scene& scene, const Camera& camera)
    : impl_(std::make_unique<Impl>(path, scene, camera)) {
  hdf5::File& file = impl_->file;
  file.attribute("/", "schema", std::int64_t(1));
  file.attribute("/", "camera", camera.name);
  file.attribute("/instance", "names", impl_->labels.instances);
  file.attribute("/part", "names", impl_->labels.parts);
  file.write<double>("/K", {3, 3}, {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1});
}

TruthFile::~TruthFile() = default;

void TruthFile::append(const RenderedFrame& frame, const FlowFrame& forward, const FlowFrame& backward,
                       const SceneState& state, const Eigen::Matrix4d& T_world_camera) {
  Impl& to = *impl_;
  const std::size_t n_pixels = to.width * to.height;
  if (frame.depth.size() != n_pixels) throw Failure("ground truth of another size than its camera's picture was given");
  to.put(to.depth, frame.depth);
  to.put(to.distance, frame.distance);
  to.put(to.normal, frame.normal);
  to.put(to.albedo, frame.albedo);
  to.put(to.mean_normal, frame.mean_normal);
  to.put<std::uint16_t>(to.instance, {frame.instance.begin(), frame.instance.end()});
  std::vector<std::uint8_t> parts;
  for (const std::uint32_t id : frame.instance) parts.push_back(to.labels.part_of_instance.at(id));
  to.put(to.part, parts);
  const auto put_flow = [&](auto& flow, auto& flow_state, const FlowFrame& given) {
    to.put(flow, given.flow.empty() ? std::vector<float>(2 * n_pixels, 0.0f) : given.flow);
    to.put(flow_state, given.state.empty() ? std::vector<std::uint8_t>(n_pixels, 2) : given.state);
  };
  put_flow(to.forward, to.forward_state, forward);
  put_flow(to.backward, to.backward_state, backward);
  std::vector<std::int32_t> boxes;
  std::vector<std::int64_t> visible;
  std::vector<double> poses, camera_pose;
  for (const InstanceBox& box : instance_boxes(frame.instance, frame.width, to.n)) {
    boxes.insert(boxes.end(), box.corners.begin(), box.corners.end());
    visible.push_back(box.visible);
  }
  for (const Visual& visual : to.scene.visuals) {
    const bool deforms = visual.soft >= 0 || visual.cloth >= 0;
    Eigen::Matrix4d pose = deforms ? Eigen::Matrix4d(Eigen::Matrix4d::Identity()) : visual.pose.matrix();
    if (visual.rigid >= 0 && !deforms) {
      Eigen::Matrix4d body = Eigen::Matrix4d::Identity();
      body.topRows<3>() = state.rigid.at(std::size_t(visual.rigid));
      pose = body * pose;
    }
    for (int i = 0; i < 12; ++i) poses.push_back(pose(i / 4, i % 4));
  }
  for (int i = 0; i < 16; ++i) camera_pose.push_back(T_world_camera(i / 4, i % 4));
  to.put(to.box, boxes);
  to.put(to.visible, visible);
  to.put(to.pose, poses);
  to.put(to.camera_pose, camera_pose);
  to.put<double>(to.time, {state.time});
}

void TruthFile::close() {
  Impl& from = *impl_;
  from.depth.reset(), from.distance.reset(), from.normal.reset(), from.albedo.reset(), from.mean_normal.reset();
  from.forward.reset(), from.backward.reset();
  from.instance.reset(), from.part.reset(), from.forward_state.reset(), from.backward_state.reset();
  from.box.reset(), from.visible.reset(), from.pose.reset(), from.camera_pose.reset(), from.time.reset();
  from.file.close();
}

}  // namespace pvg
