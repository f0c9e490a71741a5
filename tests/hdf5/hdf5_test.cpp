// HDF5: what is written comes back, series grow by rows, equal contents are equal bytes, errors name file and object.
#include "host/hdf5/series.hpp"

#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <thread>

namespace pvg::hdf5 {
namespace {

std::filesystem::path scratch(const std::string& name) {
  return std::filesystem::temp_directory_path() / ("pvg_hdf5_" + std::to_string(getpid()) + "_" + name);
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_example(const std::filesystem::path& path) {
  File file = File::create(path);
  file.write<double>("/mesh/beaker/rest", {2, 3}, std::vector<double>{1, 2, 3, 4, 5, 6});
  file.write<std::int64_t>("/mesh/beaker/body", {}, std::vector<std::int64_t>{-7});
  file.write<std::uint32_t>("/none", {0, 3}, std::vector<std::uint32_t>{});
  file.make_group("/camera");
  Series<double> x(file, "/x", {2});
  x.append(std::vector<double>{0.5, 1.5});
  x.append(std::vector<double>{2.5, 3.5, 4.5, 5.5});
  Series<double> empty_rows(file, "/empty_rows", {0, 3});
  for (int i = 0; i < 4; ++i) empty_rows.append(std::vector<double>{});
  Series<std::uint8_t> mask(file, "/mask", {4, 4}, true);
  for (int i = 0; i < 5; ++i) mask.append(std::vector<std::uint8_t>(16, std::uint8_t(i)));
  file.attribute("/", "task", std::string("weigh_beaker"));
  file.attribute("/", "seed", std::uint64_t(18446744073709551615u));
  file.attribute("/", "h", 0.01);
  file.attribute("/", "configuration", std::string(100000, 'y'));
  file.attribute("/x", "names", std::vector<std::string>{"a", "", "finger_joint"});
}

// As h5py writes a list of texts.
TEST(Hdf5, TextsOfVariableLengthAreRead) {
  const auto path = scratch("variable.h5");
  {
    File file = File::create(path);
    file.make_group("/camera");
  }
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  const hsize_t n = 3;
  const hid_t space = H5Screate_simple(1, &n, nullptr);
  const hid_t attribute =
      H5Acreate_by_name(file, "/camera", "names", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const char* names[] = {"nothing", "", "a part with a long name"};
  EXPECT_GE(H5Awrite(attribute, type, names), 0);
  H5Aclose(attribute), H5Sclose(space), H5Tclose(type), H5Fclose(file);
  EXPECT_EQ(File::open(path).texts_attribute("/camera", "names"),
            (std::vector<std::string>{"nothing", "", "a part with a long name"}));
  std::filesystem::remove(path);
}

TEST(Hdf5, WhatIsWrittenComesBack) {
  const auto path = scratch("back.h5");
  write_example(path);
  {
    const File file = File::open(path);
    EXPECT_EQ(file.shape("/mesh/beaker/rest"), (Shape{2, 3}));
    EXPECT_EQ(file.read<double>("/mesh/beaker/rest").values, (std::vector<double>{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(file.read<std::int64_t>("/mesh/beaker/body").values, std::vector<std::int64_t>{-7});
    EXPECT_EQ(file.shape("/none"), (Shape{0, 3}));
    EXPECT_EQ(file.read<double>("/x").values, (std::vector<double>{0.5, 1.5, 2.5, 3.5, 4.5, 5.5}));
    EXPECT_EQ(file.shape("/x"), (Shape{3, 2}));
    EXPECT_EQ(file.shape("/empty_rows"), (Shape{4, 0, 3}));
    EXPECT_EQ(file.read<std::uint8_t>("/mask").values[4 * 16 + 3], 4);
    EXPECT_EQ(file.text_attribute("/", "task"), "weigh_beaker");
    EXPECT_EQ(file.number_attribute("/", "h"), 0.01);
    EXPECT_EQ(file.text_attribute("/", "configuration"), std::string(100000, 'y'));
    EXPECT_EQ(file.texts_attribute("/x", "names"), (std::vector<std::string>{"a", "", "finger_joint"}));
    EXPECT_TRUE(file.has("/mesh/beaker/rest"));
    EXPECT_FALSE(file.has("/mesh/cup/rest"));
    EXPECT_EQ(file.children("/"), (std::vector<std::string>{"camera", "empty_rows", "mask", "mesh", "none", "x"}));
  }
  std::filesystem::remove(path);
}

// HDF5 itself undoes what was compressed outside of it: chunks that rows fill and that they do not, wider than a row,
// of bytes alone.
TEST(Hdf5, CompressedRowsComeBackWhateverTheirChunk) {
  const auto path = scratch("compressed.h5");
  const std::uint64_t n_rows = 11;
  std::vector<double> values(n_rows * 15);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = double(i * i) / 7 - 300;
  const std::vector<Shape> chunks = {{4, 5, 3}, {4, 2, 1}, {1, 5, 3}, {64, 4, 2}, {11, 5, 3}, {3, 3, 2}};
  File file = File::create(path);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    const bool shuffles = i % 2 == 0;
    Series<double> series(file, "/x" + std::to_string(i), {5, 3}, Storage{6, shuffles, chunks[i]});
    std::size_t at = 0;
    for (const std::size_t n : {1, 3, 6, 0, 1}) {
      series.append({values.data() + at * 15, n * 15});
      at += n;
    }
    Series<std::uint16_t> moved(file, "/moved" + std::to_string(i), {5}, Storage{1, shuffles, {2, 3}});
    Series<std::uint16_t> taken(std::move(moved));
    taken.append(std::vector<std::uint16_t>{1, 2, 3, 4, 65535});
  }
  file.close();
  const File read = File::open(path);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    const Array<double> x = read.read<double>("/x" + std::to_string(i));
    EXPECT_EQ(x.shape, (Shape{n_rows, 5, 3})) << i;
    EXPECT_EQ(x.values, values) << i;
    EXPECT_EQ(read.read_row<double>("/x" + std::to_string(i), 10), std::vector(values.end() - 15, values.end())) << i;
    const Array<std::uint16_t> taken = read.read<std::uint16_t>("/moved" + std::to_string(i));
    EXPECT_EQ(taken.shape, (Shape{1, 5})) << i;
    EXPECT_EQ(taken.values, (std::vector<std::uint16_t>{1, 2, 3, 4, 65535})) << i;
  }
  std::filesystem::remove(path);
}

TEST(Hdf5, WhatRepeatsIsCompressed) {
  const auto path = scratch("repeats.h5");
  File file = File::create(path);
  {
    Series<double> series(file, "/x", {1000}, Storage{6, true, {10, 1000}});
    series.append(std::vector<double>(100 * 1000, 0.1));
  }
  file.close();
  EXPECT_LT(std::filesystem::file_size(path), 20000u);  // of 800,000
  std::filesystem::remove(path);
}

TEST(Hdf5, EqualContentsAreEqualBytesEvenASecondLater) {
  const auto first = scratch("first.h5"), second = scratch("second.h5");
  write_example(first);
  usleep(1100000);  // the times that objects would carry count seconds
  write_example(second);
  EXPECT_TRUE(bytes_of(first) == bytes_of(second));
  std::filesystem::remove(first);
  std::filesystem::remove(second);
}

TEST(Hdf5, ErrorsNameFileAndObject) {
  const auto path = scratch("errors.h5");
  File file = File::create(path);
  Series<double> x(file, "/x", {3});
  for (const auto& wrong : {std::function<void()>([&] {
                              x.append(std::vector<double>{1, 2});
                            }),
                            std::function<void()>([&] {
                              file.write<double>("/x", {2}, std::vector<double>{1, 2, 3});
                            })})
    try {
      wrong();
      ADD_FAILURE() << "nothing was thrown";
    } catch (const Failure& error) {
      EXPECT_NE(std::string(error.what()).find("errors.h5"), std::string::npos);
      EXPECT_NE(std::string(error.what()).find("/x"), std::string::npos);
    }
  EXPECT_THROW(File::open("/no/such/file.h5"), UsageError);
  EXPECT_THROW(File::create("/no/such/folder/file.h5"), Failure);
  std::filesystem::remove(path);
}

// Writes 480 kB where 64 KiB fit, as on a full disk, and ends the process as the program would.
void write_too_much(const std::filesystem::path& path, const Storage& storage) {
  signal(SIGXFSZ, SIG_IGN);  // writing fails instead
  const rlimit most{64 << 10, 64 << 10};
  setrlimit(RLIMIT_FSIZE, &most);
  try {
    File file = File::create(path);
    std::vector<Series<double>> series;
    for (const std::string name : {"/x", "/y", "/z"}) series.emplace_back(file, name, Shape{1000}, storage);
    std::mt19937 random;  // of what cannot be compressed
    std::vector<double> row(1000);
    for (Series<double>& one : series)
      for (int i = 0; i < 20; ++i) {
        for (double& value : row) value = std::generate_canonical<double, 53>(random);
        one.append(row);
      }
    series.clear();
    file.close();
  } catch (const Failure& failure) {
    std::fprintf(stderr, "%s", failure.what());
    std::exit(1);
  }
  std::exit(0);
}

TEST(Hdf5, AFullDiskIsOneSentenceAndTheProgramEndsAsItWants) {
  // the same in the process that is started anew below
  const auto path = std::filesystem::temp_directory_path() / "pvg_hdf5_full.h5";
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // a process of its own: one that ends as this one would
  const testing::ExitedWithCode fails(1);
  EXPECT_EXIT(write_too_much(path, {}), fails, "full.h5: HDF5 could not");
  EXPECT_EXIT(write_too_much(path, {6, true, {8, 1000}}), fails, "full.h5: HDF5 could not write");
  // all rows wait until the series ends, and nobody is there to take an error then
  EXPECT_EXIT(write_too_much(path, {6, true, {64, 1000}}), fails, "full.h5: HDF5 could not write /.; is the disk full");
  std::filesystem::remove(path);
}

// the library's own stack of errors, which each thread would print, beside our sentence
TEST(Hdf5, NoThreadPrintsMoreThanItsError) {
  const auto path = scratch("quiet.h5");
  write_example(path);
  const File file = File::open(path);
  testing::internal::CaptureStderr();
  std::thread([&] { EXPECT_THROW(file.shape("/missing"), UsageError); }).join();
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace pvg::hdf5
