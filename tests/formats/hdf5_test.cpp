// HDF5: what is written comes back, series grow by rows, equal contents are equal bytes, errors name file and object.
#include "host/formats/hdf5.hpp"

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

TEST(Hdf5, AFullDiskIsOneSentenceAndTheProgramEndsAsItWants) {
  // the same in the process that is started anew below
  const auto path = std::filesystem::temp_directory_path() / "pvg_hdf5_full.h5";
  const auto write_too_much = [&path] {
    signal(SIGXFSZ, SIG_IGN);  // as on a full disk, writing fails
    const rlimit most{64 << 10, 64 << 10};
    setrlimit(RLIMIT_FSIZE, &most);
    try {
      File file = File::create(path);
      std::vector<Series<double>> series;
      for (const std::string name : {"/x", "/y", "/z"}) series.emplace_back(file, name, Shape{1000});
      for (Series<double>& one : series)
        for (int i = 0; i < 20; ++i) one.append(std::vector<double>(1000, i));
      series.clear();
      file.close();
    } catch (const Failure& failure) {
      std::fprintf(stderr, "%s", failure.what());
      std::exit(1);
    }
    std::exit(0);
  };
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // a process of its own: one that ends as this one would
  EXPECT_EXIT(write_too_much(), testing::ExitedWithCode(1), "full.h5: HDF5 could not");
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
