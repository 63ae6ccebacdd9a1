#include <gtest/gtest.h>
#include <mpi.h>

namespace {

class Mpi : public testing::Environment {
 public:
    void SetUp() override {
        MPI_Init(nullptr, nullptr);
        int rank = 0;
        MPI_Comm_rank(MPI_COMM_WORLD, &rank);
        testing::TestEventListeners& listeners = testing::UnitTest::GetInstance()->listeners();
        if (rank != 0) delete listeners.Release(listeners.default_result_printer());
    }
    void TearDown() override { MPI_Finalize(); }
};

const auto* const environment = testing::AddGlobalTestEnvironment(new Mpi);

}  // namespace
