/// Cells of twice the shipped size, a ninth of the time.

#include "tests/study/quiet_fields.hpp"

namespace repose::study {
namespace {

class QuietFields : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes, QuietFields, ::testing::ValuesIn(six_scenes),
                         [](const auto& one) { return std::string(one.param); });

TEST_P(QuietFields, OfCoarserCells) { expect_quiet_fields(GetParam(), {"grid.h=0.0125"}); }

}  // namespace
}  // namespace repose::study
