/// The shipped settings: the table of docs/noise.md.

#include "tests/study/quiet_fields.hpp"

namespace repose::study {
namespace {

class QuietShippedFields : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes, QuietShippedFields, ::testing::ValuesIn(six_scenes),
                         [](const auto& one) { return std::string(one.param); });

TEST_P(QuietShippedFields, AsTheyAre) { expect_quiet_fields(GetParam(), {}); }

}  // namespace
}  // namespace repose::study
