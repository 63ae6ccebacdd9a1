#include "core/base/table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace tomodem {
namespace {

TEST(Table, IsCsvWithOneHeaderLine) {
    Table table({"run", "rate [1/s]", "points [-]"});
    table.add({std::string("a.h5"), 0.001, std::int64_t(12)});
    EXPECT_EQ(table.csv(), "run,rate [1/s],points [-]\na.h5,0.001,12\n");
}

TEST(Table, LeavesANumberThatDoesNotExistEmpty) {
    Table table({"a", "b"});
    table.add({Table::Cell(), 1.5});
    EXPECT_EQ(table.csv(), "a,b\n,1.5\n");
}

TEST(Table, QuotesAComma) {
    Table table({"run"});
    table.add({std::string("rate 1,5 \"fast\".h5")});
    EXPECT_EQ(table.csv(), "run\n\"rate 1,5 \"\"fast\"\".h5\"\n");
}

TEST(Table, IsAJsonListOfRowsUnderTheNamesWithoutUnits) {
    Table table({"run", "rate [1/s]", "points [-]", "last"});
    table.add({std::string("a \"b\\.h5"), 0.001, std::int64_t(12), Table::Cell()});
    table.add({std::string("c"), std::nan(""), std::int64_t(-1), 0.1});
    EXPECT_EQ(table.json().dump(), R"([{"run":"a \"b\\.h5","rate":0.001,"points":12,"last":null},)"
                                   R"({"run":"c","rate":null,"points":-1,"last":0.1}])");
    EXPECT_EQ(Table({"a"}).json().dump(), "[]");
}

}  // namespace
}  // namespace tomodem
