// Video: the frames that went in are counted by ffprobe and come back close, equal frames are equal bytes, errors are
// sentences.
#include "host/formats/video.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <vector>

namespace pvg {
namespace {

std::filesystem::path video_path(const std::string& name) {
  return std::filesystem::temp_directory_path() / ("pvg_video_" + std::to_string(getpid()) + "_" + name);
}

constexpr int WIDTH = 64, HEIGHT = 48;

// flat colour that changes from frame to frame: survives lossy coding
std::vector<std::uint8_t> flat_frame(int i) {
  std::vector<std::uint8_t> rgb(WIDTH * HEIGHT * 3);
  for (std::size_t p = 0; p < rgb.size(); p += 3) {
    rgb[p] = std::uint8_t(20 + 10 * i);
    rgb[p + 1] = 128;
    rgb[p + 2] = std::uint8_t(220 - 10 * i);
  }
  return rgb;
}

void write_video(const std::filesystem::path& path, int n) {
  VideoWriter video(path, WIDTH, HEIGHT, 12.5);
  for (int i = 0; i < n; ++i) video.write(flat_frame(i));
  video.finish();
}

std::string output_of(const std::string& command) {
  std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  std::array<char, 4096> part;
  for (std::size_t n; (n = fread(part.data(), 1, part.size(), pipe.get())) > 0;) text.append(part.data(), n);
  return text;
}

std::string bytes_of_video(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Video, HasTheFramesTheRateAndTheFormatThatWereAskedFor) {
  const auto path = video_path("format.mp4");
  write_video(path, 17);
  const std::string said = output_of(
      "ffprobe -v error -count_frames -select_streams v:0 -show_entries "
      "stream=codec_name,pix_fmt,width,height,r_frame_rate,avg_frame_rate,nb_read_frames,has_b_frames,start_pts -of "
      "default=noprint_wrappers=1 " +
      path.string());
  for (const char* line : {"codec_name=h264\n", "pix_fmt=yuv420p\n", "width=64\n", "height=48\n", "has_b_frames=0\n",
                           "r_frame_rate=25/2\n", "avg_frame_rate=25/2\n", "start_pts=0\n", "nb_read_frames=17\n"})
    EXPECT_NE(said.find(line), std::string::npos) << line << said;
  std::filesystem::remove(path);
}

TEST(Video, ColoursComeBackWithinAFewLevels) {
  const auto path = video_path("colours.mp4");
  write_video(path, 5);
  const std::string raw = output_of("ffmpeg -v error -i " + path.string() +
                                    " -vf scale=in_color_matrix=bt709:flags=accurate_rnd+full_chroma_int -f rawvideo "
                                    "-pix_fmt rgb24 -");
  ASSERT_EQ(raw.size(), 5u * WIDTH * HEIGHT * 3);
  for (int i = 0; i < 5; ++i) {
    const std::vector<std::uint8_t> sent = flat_frame(i);
    const std::size_t middle = std::size_t(WIDTH * (HEIGHT / 2) + WIDTH / 2) * 3;
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(int(std::uint8_t(raw[std::size_t(i) * sent.size() + middle + c])), int(sent[middle + c]), 4);
  }
  std::filesystem::remove(path);
}

TEST(Video, EqualFramesAreEqualBytes) {
  const auto first = video_path("first.mp4"), second = video_path("second.mp4");
  write_video(first, 6);
  usleep(1100000);
  write_video(second, 6);
  EXPECT_FALSE(bytes_of_video(first).empty());
  EXPECT_TRUE(bytes_of_video(first) == bytes_of_video(second));
  std::filesystem::remove(first);
  std::filesystem::remove(second);
}

TEST(Video, AFolderThatIsMissingIsAnErrorThatNamesTheFile) {
  try {
    VideoWriter video("/no/such/folder/out.mp4", WIDTH, HEIGHT, 10);
    for (int i = 0; i < 50; ++i) video.write(flat_frame(i));
    video.finish();
    FAIL() << "nothing was thrown";
  } catch (const Failure& error) {
    EXPECT_NE(std::string(error.what()).find("/no/such/folder/out.mp4"), std::string::npos) << error.what();
  }
}

TEST(Video, OddSizesAndAMissingProgramAreUsageErrors) {
  EXPECT_THROW(VideoWriter(video_path("odd.mp4"), 63, 48, 10), UsageError);
  EXPECT_THROW(VideoWriter(video_path("odd.mp4"), 64, 48, 0), UsageError);
  const std::string before = std::getenv("PATH");
  setenv("PATH", "/nonexistent", 1);
  try {
    VideoWriter video(video_path("none.mp4"), WIDTH, HEIGHT, 10);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "the program ffmpeg was not found on PATH; install it (Debian package ffmpeg)");
  }
  setenv("PATH", before.c_str(), 1);
}

}  // namespace
}  // namespace pvg
