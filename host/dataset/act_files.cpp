#include "host/dataset/act_files.hpp"

#include "host/hdf5/series.hpp"

namespace pvg {
namespace {

using hdf5::Series;

std::vector<float> floats(const std::vector<double>& row) { return {row.begin(), row.end()}; }

class ActWriter : public DataSetWriter {
 public:
  ActWriter(std::filesystem::path folder, std::size_t n_rows) : folder_(std::move(folder)), n_rows_(n_rows) {}

  void add(const PackedEpisode& episode) override {
    hdf5::File file = hdf5::File::create(folder_ / ("episode_" + std::to_string(n_episodes_++) + ".hdf5"));
    file.attribute("/", "sim", std::int64_t(1));
    file.attribute("/", "length", std::int64_t(episode.n_frames()));
    file.attribute("/", "frames_per_second", episode.frames_per_second);
    write_rows(file, "/observations/qpos", episode.state);
    write_rows(file, "/observations/qvel", episode.velocity);
    write_rows(file, "/action", episode.action);
    file.attribute("/action", "names", episode.columns);
    std::vector<std::uint8_t> is_pad(n_rows_, 1);
    std::fill_n(is_pad.begin(), episode.n_frames(), std::uint8_t(0));
    file.write<std::uint8_t>("/is_pad", {n_rows_}, is_pad);
    file.make_group("/observations/images");
    for (const PackedCamera& camera : episode.cameras) write_pictures(file, camera, episode.n_frames());
    file.close();
  }
  void finish() override {}

 private:
  void write_rows(hdf5::File& file, const std::string& name, const Rows& rows) {
    std::vector<float> values;
    for (std::size_t i = 0; i < n_rows_; ++i) {
      const std::vector<float> row = floats(i < rows.size() ? rows[i] : rows.back());
      values.insert(values.end(), row.begin(), row.end());
    }
    file.write<float>(name, {n_rows_, rows.front().size()}, values);
  }
  void write_pictures(hdf5::File& file, const PackedCamera& camera, std::size_t n_frames) {
    Series<std::uint8_t> pictures(file, "/observations/images/" + camera.name,
                                  {std::uint64_t(camera.height), std::uint64_t(camera.width), 3});
    std::vector<std::uint8_t> last;
    read_pictures(camera, n_frames, 0, [&](auto rgb) {
      pictures.append(rgb);
      last.assign(rgb.begin(), rgb.end());
    });
    for (std::size_t i = n_frames; i < n_rows_; ++i) pictures.append(last);
  }

  std::filesystem::path folder_;
  std::size_t n_rows_, n_episodes_ = 0;
};

}  // namespace

std::unique_ptr<DataSetWriter> make_act_writer(const std::filesystem::path& folder, std::size_t n_rows) {
  return std::make_unique<ActWriter>(folder, n_rows);
}

}  // namespace pvg
