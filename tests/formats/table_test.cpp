#include "host/formats/table.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/base/error.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

TEST(MeasuredTable, ColumnsAreFoundByTheNamesOfTheHeader) {
  const TestFolder folder;
  const MeasuredTable r = read_table(folder.write("a.csv", "t,x_m\r\n0,-1.5e-3\r\n0.01,2\r\n"));
  EXPECT_EQ(r.n_rows, 2u);
  EXPECT_EQ(r["t"], (std::vector<double>{0, 0.01}));
  EXPECT_EQ(r["x_m"], (std::vector<double>{-1.5e-3, 2}));
  expect_error<UsageError>([&] { r["y"]; }, {"a.csv", "`y`"});
}

TEST(MeasuredTable, WhatIsNoTableOfNumbersIsRefusedByLine) {
  const TestFolder folder;
  expect_error<UsageError>([&] { read_table(folder.path / "b.csv"); }, {"b.csv"});
  expect_error<UsageError>([&] { read_table(folder.write("b.csv", "")); }, {"b.csv", "empty"});
  expect_error<UsageError>([&] { read_table(folder.write("b.csv", "t,x\n0,1\n1\n")); }, {"b.csv, line 3", "columns"});
  expect_error<UsageError>([&] { read_table(folder.write("b.csv", "t,x\n0,fast\n")); }, {"b.csv, line 2", "`fast`"});
  expect_error<UsageError>([&] { read_table(folder.write("b.csv", "t,x\n0,1 2\n")); }, {"b.csv, line 2", "`1 2`"});
  for (const char* sign : {"+", "-"})
    expect_error<UsageError>([&] { read_table(folder.write("b.csv", "t,x\n0," + std::string(sign) + "\n")); },
                             {"b.csv, line 2", sign, "no number"});
  for (const char* large : {"1e16", "-1e16", "inf", "1e400", "-1e400"})
    expect_error<UsageError>([&] { read_table(folder.write("b.csv", "t,x\n0," + std::string(large) + "\n")); },
                             {"b.csv, line 2", large, "too large"});
  EXPECT_EQ(read_table(folder.write("b.csv", "t,x\n0,1e-400\n"))["x"], std::vector<double>{0});
}

// As Motive exports rigid bodies: a line about the take, then names, kinds and axes above each other.
TEST(MeasuredTable, OfMotionCaptureHasItsNamesInSeveralLines) {
  const TestFolder folder;
  folder.write("take.csv", R"(Format Version,1.23,Take Name,throw,Export Frame Rate,120.0

,Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body
,Name,cube,cube,hand,hand
,ID,"A1","A1","B2","B2"
,,Rotation,Position,Position,Mean Error
Frame,Time (Seconds),X,X,X,
0,0.000000,0.5,1.25,7,0.001
1,0.008333,0.6,,8,0.001
)");
  const MeasuredTable table = read_table(folder.path / "take.csv");
  EXPECT_EQ(table.n_rows, 2u);
  EXPECT_EQ(table["Time (Seconds)"][1], 0.008333);
  EXPECT_EQ(table["cube Rotation X"][1], 0.6);
  EXPECT_EQ(table["cube Position X"][0], 1.25);
  EXPECT_TRUE(std::isnan(table["cube Position X"][1]));
  EXPECT_EQ(table["hand Position X"][1], 8);
}

TEST(MeasuredTable, LogsAreRefusedWithTheCommandThatConvertsThem) {
  const TestFolder folder;
  for (const char* name : {"run.mcap", "run.db3", "run.bag", "run.c3d"}) {
    folder.write(name, "t\n");
    expect_error<UsageError>([&] { read_table(folder.path / name); }, {name, "scripts/convert_log.py"});
  }
  folder.write("run.mat", "t\n");
  expect_error<UsageError>([&] { read_table(folder.path / "run.mat"); }, {"run.mat", "export", "CSV"});
}

TEST(MeasuredTable, AFoldersFilesAreThoseOfThePrefixInTheOrderOfTheirNames) {
  const TestFolder folder;
  for (const char* name : {"run_b.csv", "run_a.csv", "run_a.txt", "other.csv"}) folder.write(name, "t\n");
  EXPECT_EQ(tables_in(folder.path, "run_"),
            (std::vector<std::filesystem::path>{folder.path / "run_a.csv", folder.path / "run_b.csv"}));
  EXPECT_TRUE(tables_in(folder.path / "nowhere", "run_").empty());
}

}  // namespace
}  // namespace pvg
