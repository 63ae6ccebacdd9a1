#include "tools/metrics/table.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace tomodem
