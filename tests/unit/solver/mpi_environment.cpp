#include <gtest/gtest.h>
#include <mpi.h>

namespace {

class Mpi : public testing::Environment {
 public:
    void SetUp() override { MPI_Init(nullptr, nullptr); }
    void TearDown() override { MPI_Finalize(); }
};

const auto* const environment = testing::AddGlobalTestEnvironment(new Mpi);

}  // namespace
