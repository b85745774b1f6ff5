/// Laws from outside: known by name once registered, never under another's name.
#include "models/register_law.hpp"

#include <thread>

#include <gtest/gtest.h>

#include "models/all_laws.hpp"
#include "models/newtonian.hpp"

namespace repose {
namespace {

/// The library's fluid under another name, so that there is something to compare with.
template <char letter>
struct Fluid : Newtonian<Tension::carried> {
  static constexpr std::array<char, 7> letters{'f', 'l', 'u', 'i', 'd', '_', letter};
  static constexpr std::string_view name{letters.data(), letters.size()};
  static constexpr std::string_view option_key = "";
  static constexpr std::string_view option = "";
};

template <char letter>
struct Stiff : Fluid<letter> {
  static constexpr std::string_view option_key = "stiffness";
  static constexpr std::string_view option = "stiff";
};
template <char letter>
struct Soft : Fluid<letter> {
  static constexpr std::string_view option_key = "stiffness";
  static constexpr std::string_view option = "soft";
};

struct Nameless : Newtonian<Tension::carried> {
  static constexpr std::string_view name = "";
};

LawSpec spec(std::string name, std::map<std::string, std::string> options = {}) {
  return {std::move(name), std::move(options), {{"eta", 2.0}, {"K", 1e5}, {"rho_0", 1e3}}};
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "name");
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

std::vector<std::string> names() {
  std::vector<std::string> list;
  for (const LawInfo& law : all_laws())
    list.push_back(std::string(law.name) + " " + std::string(law.option));
  return list;
}

// The law found by its name answers what the library's own does with the same numbers.
TEST(OutsideLaw, IsFoundByNameAndComputes) {
  EXPECT_THROW(find_law(spec("fluid_a")), InputError);
  register_law<Fluid<'a'>>();
  EXPECT_EQ(find_law(spec("fluid_a")).name, "fluid_a");
  const auto outside = make_material(spec("fluid_a"));
  const auto own = make_material(spec("newtonian", {{"tension_cutoff", "false"}}));
  EXPECT_EQ(outside->theta().size(), own->theta().size());
  EXPECT_EQ(outside->parameter("alpha"), 7.0) << "the default";
  EXPECT_EQ(outside->density_at(1e4, 1.0), own->density_at(1e4, 1.0));
  EXPECT_EQ(outside->law().name, "fluid_a");
  EXPECT_NE(find_outside(outside->law()), nullptr);
  EXPECT_EQ(find_outside(own->law()), nullptr);
  EXPECT_FALSE(shear_response(*outside, 1e3, 1.0).has_value()) << "it has no such stress";
  EXPECT_THROW(make_material({"fluid_a", {}, {{"eta", -1.0}, {"K", 1e5}, {"rho_0", 1e3}}}),
               InputError)
      << "its own table's ranges hold";
}

TEST(OutsideLaw, HasFormsOfWhichTheFirstIsTheDefault) {
  register_law<Stiff<'b'>, Soft<'b'>>();
  EXPECT_EQ(find_law(spec("fluid_b")).option, "stiff");
  EXPECT_EQ(find_law(spec("fluid_b", {{"stiffness", "soft"}})).option, "soft");
  EXPECT_EQ(make_material(spec("fluid_b", {{"stiffness", "soft"}}))->law().option, "soft");
  EXPECT_THROW(find_law(spec("fluid_b", {{"stiffness", "liquid"}})), InputError);
}

TEST(OutsideLaw, NameStandsForOneLaw) {
  register_law<Fluid<'c'>>();
  const std::vector<std::string> before = names();
  EXPECT_NE(message_of([] { register_law<Fluid<'c'>>(); }).find("registered already"),
            std::string::npos);
  EXPECT_NE(message_of([] { register_law<Soft<'c'>>(); }).find("registered already"),
            std::string::npos);
  EXPECT_NE(message_of([] { register_law<Newtonian<Tension::carried>>(); }).find("library's own"),
            std::string::npos);
  EXPECT_NE(message_of([] { register_law<Nameless>(); }).find("name"), std::string::npos);
  EXPECT_NE(message_of([] { register_law<Fluid<'d'>, Fluid<'e'>>(); }).find("two laws"),
            std::string::npos);
  EXPECT_NE(message_of([] { register_law<Soft<'d'>, Soft<'d'>>(); }).find("two forms"),
            std::string::npos);
  EXPECT_NE(message_of([] { register_law<Fluid<'d'>, Soft<'d'>>(); }).find("option keys"),
            std::string::npos);
  EXPECT_NE(message_of([] { register_law(std::vector<OutsideLaw>{}); }).find("no form"),
            std::string::npos);
  EXPECT_NE(message_of([] { register_law({OutsideLaw{}}); }).find("needs info"), std::string::npos);
  EXPECT_EQ(names(), before) << "what failed has left nothing behind";
}

// A law that nobody has registered is no law, whatever stands last in a list of them.
TEST(OutsideLaw, UnknownIsAnError) {
  static constexpr LawInfo stranger{"stranger", "", "", "", {}, {}, true};
  class Stranger final : public Material {
   public:
    Stranger() : Material({}) {}
    const LawInfo& law() const override { return stranger; }
    UpdateReport update(const Batch&) const override { return {}; }
    UpdateReport update(const SpatialBatch&) const override { return {}; }
    void stored_energy(const Batch&, double*) const override {}
    void stored_energy(const SpatialBatch&, double*) const override {}
    void modulus(const Batch&, double*) const override {}
    void modulus(const SpatialBatch&, double*) const override {}
    void elastic_volume_strain(const Batch&, double*) const override {}
    void viscosity(const Batch&, double*, double*) const override {}
    InitialPoint initial(const InitialConditions&) const override { return {}; }
    double density_at(double, double) const override { return 0.0; }
  };
  EXPECT_NE(message_of([] { find_outside(stranger); }).find("stranger"), std::string::npos);
  std::vector<double> theta;
  message_of([&] { complete_parameters(stranger, theta); });
  message_of([] { shear_response(Stranger(), 1e3, 1.0); });
  message_of([] { visit_law(stranger, [](auto) {}); });
  EXPECT_THROW(find_law({"stranger", {}, {}}), InputError);
  // a form that a known law does not have is as unknown
  LawInfo mixed = find_law({"mu_i", {}, {}});
  mixed.option = "no such form";
  message_of([&] { find_outside(mixed); });
}

template <char... letters>
void register_at_once() {
  std::vector<std::thread> threads;
  (threads.emplace_back([] {
    for (int i = 0; i < 100; ++i) names();
    register_law<Fluid<letters>>();
    for (int i = 0; i < 100; ++i) find_law(spec(std::string(Fluid<letters>::name)));
  }),
   ...);
  for (std::thread& thread : threads) thread.join();
}

TEST(OutsideLaw, ListIsTheSameWhateverTheOrder) {
  const LawList before = all_laws();
  const std::size_t count = before.size();
  register_at_once<'z', 'p', 's', 'q'>();
  EXPECT_EQ(before.size(), count) << "a list is of one moment";
  const LawList after = all_laws();
  ASSERT_EQ(after.size(), count + 4);
  for (std::size_t i = 0; i < library_laws().size(); ++i)
    EXPECT_EQ(&after[i], &library_laws()[i]) << "the library's own come first, in their order";
  std::vector<std::string_view> outside;
  for (std::size_t i = library_laws().size(); i < after.size(); ++i)
    outside.push_back(after[i].name);
  EXPECT_TRUE(std::is_sorted(outside.begin(), outside.end()));
}

}  // namespace
}  // namespace repose
