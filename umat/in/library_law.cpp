#include "umat/in/library_law.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <fstream>
#include <iterator>
#include <mutex>
#include <set>

#include <fmt/format.h>

#include "io/fingerprint.hpp"
#include "umat/in/installation.hpp"
#include "umat/in/library_material.hpp"
#include "umat/in/point_driver.hpp"

namespace repose::umat {
namespace {

namespace fs = std::filesystem;

/// A law with the texts that its tables are views of; lives until the program ends.
struct Form {
  Description description;
  std::string identity;
  std::deque<std::string> texts;
  std::vector<ParamInfo> parameters;
  std::vector<StateField> state;
  LawInfo info;
};

class Forms {
 public:
  static Forms& instance() {
    static Forms* const only = new Forms;  // laws may be asked for until the very end
    return *only;
  }
  std::mutex mutex;
  std::deque<Form> all;
};

/// Everything that makes the law what it is, in words: what a LawSpec carries as its option.
std::string identity_of(const Description& d) {
  const Library& l = d.library;
  return fmt::format("{} ({}, {} as {}, {} props {}, statev {} from {}, void ratio {}, {} s{})",
                     l.file.string(), l.content, l.symbol, l.cmname, l.nprops,
                     fmt::join(d.names, " "), l.nstatv, fmt::join(d.initial_statev, " "),
                     d.void_ratio_statev, l.time_limit_s, d.has_grain_density ? ", rho_p" : "");
}

void check(const Description& d) {
  if (d.library.nstatv > most_statev)
    throw InputError("statev", fmt::format("statev = {} is out of range: there is room for 0 to {}",
                                           d.library.nstatv, most_statev));
  if (d.void_ratio_statev < 0 || static_cast<std::size_t>(d.void_ratio_statev) > d.library.nstatv)
    throw InputError("void_ratio_statev",
                     fmt::format("void_ratio_statev = {} is out of range: it must be one of the {} "
                                 "state variables, from 1",
                                 d.void_ratio_statev, d.library.nstatv));
  std::set<std::string> names;
  for (std::size_t i = 0; i < d.library.nprops; ++i) {
    const std::string name = prop_name(d, i);
    if (name == density_name || name == grain_density_name)
      throw InputError("names", fmt::format("names: \"{}\" is a parameter of every umat", name));
    if (!names.insert(name).second)
      throw InputError("names", fmt::format("names: \"{}\" stands there twice", name));
  }
}

void fill_tables(Form& form) {
  const Description& d = form.description;
  const auto keep = [&](std::string text) -> std::string_view {
    return form.texts.emplace_back(std::move(text));
  };
  for (std::size_t i = 0; i < d.library.nprops; ++i) {
    ParamInfo p;
    p.name = keep(prop_name(d, i));
    p.symbol = keep(fmt::format("PROPS({})", i + 1));
    p.unit = "-";
    p.doc = "as the library defines it";
    form.parameters.push_back(p);
  }
  form.parameters.push_back({density_name, "ρ₀", "kg/m³",
                             "density at the start; a scene needs it, or rho_p with v or e",
                             Need::optional, std::nan(""), positive});
  if (d.has_grain_density)
    form.parameters.push_back({grain_density_name, "ρ_p", "kg/m³", "density of the grains",
                               Need::required, std::nan(""), positive});
  for (std::size_t i = 0; i < d.library.nstatv; ++i)
    form.state.push_back({keep(fmt::format("statev_{}", i + 1)),
                          keep(fmt::format("STATEV({})", i + 1)), "-",
                          "as the library defines it"});
  constexpr std::array<std::string_view, 6> strain{"stran_xx", "stran_yy", "stran_zz",
                                                   "stran_xy", "stran_yz", "stran_zx"};
  for (const std::string_view name : strain)
    form.state.push_back({name, "STRAN", "-", "strain since the start, tensor component"});
  form.state.push_back({"elapsed", "TIME", "s", "time since the start"});
  form.state.push_back({"increments", "KINC", "-", "increments since the start"});
  form.state.push_back({"SSE", "SSE", "J/m³", "stored energy that the library reports"});
  form.state.push_back({"SPD", "SPD", "J/m³", "dissipated energy that the library reports"});
  form.state.push_back({"modulus", "ρc²", "Pa", "what the step size is made of"});
  form.info.name = law_name;
  form.info.option_key = "library";
  form.info.option = form.identity;
  form.info.doc = law_doc;
  form.info.parameters = form.parameters;
  form.info.state = form.state;
  form.info.has_stress_memory = true;
}

}  // namespace

std::string prop_name(const Description& d, std::size_t i) {
  if (i < d.names.size() && !d.names[i].empty()) return d.names[i];
  return fmt::format("prop_{}", i + 1);
}

fs::path find_library(const std::string& text, const fs::path& folder) {
  std::error_code ignored;
  const fs::path beside = fs::absolute(folder / text).lexically_normal();
  std::vector<fs::path> all{beside};
  const bool bare = !fs::path(text).has_parent_path();
  if (bare)
    for (const fs::path& shipped : places("", "lib/repose/umat")) all.push_back(shipped / text);
  for (const fs::path& place : all)
    if (fs::is_regular_file(place, ignored)) return place;
  if (fs::exists(beside, ignored))
    throw InputError(
        "library", fmt::format("{} is {}, and a shared library is needed", beside.string(),
                               fs::is_directory(beside, ignored) ? "a folder" : "no regular file"));
  std::string near;
  for (const fs::path& place : all) {
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(place.parent_path(), ignored))
      files.push_back(entry.path().filename().string());
    std::sort(files.begin(), files.end());
    near = nearest_name(place.filename().string(),
                        std::vector<std::string_view>(files.begin(), files.end()));
    if (near.empty()) continue;
    near = fmt::format("; did you mean {}?", (fs::path(text).parent_path() / near).string());
    break;
  }
  throw InputError(
      "library",
      fmt::format("there is no {}{}{}", beside.string(),
                  bare ? ", nor one of that name among the libraries of repose" : "", near));
}

std::string content_of(const fs::path& library) {
  std::ifstream in(library, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (!in.good() && !in.eof())
    throw InputError("library", fmt::format("{} cannot be read", library.string()));
  return io::fingerprint_of(bytes);
}

void check_library(const Library& library) {
  try {
    const HostProcess process(library);
  } catch (const Failure& failure) {
    throw InputError(failure.fault() == Fault::no_symbol ? "symbol" : "library", failure.what());
  }
}

std::string make_known(const Description& description) {
  check(description);
  std::string identity = identity_of(description);
  Forms& forms = Forms::instance();
  const std::lock_guard lock(forms.mutex);
  for (const Form& form : forms.all)
    if (form.identity == identity) return identity;
  Form& form = forms.all.emplace_back();
  form.description = description;
  form.identity = identity;
  fill_tables(form);
  OutsideLaw law;
  law.info = &form.info;
  law.complete = [](std::vector<double>&) {};
  law.make = [&form](std::vector<double> theta) -> std::unique_ptr<Material> {
    return std::make_unique<LibraryMaterial>(form.info, form.description, std::move(theta));
  };
  law.point = std::make_shared<PointDriver>(form.info, form.description);
  register_form(law);
  return identity;
}

const Description* description_of(const LawInfo& law) {
  if (law.name != law_name) return nullptr;
  Forms& forms = Forms::instance();
  const std::lock_guard lock(forms.mutex);
  for (const Form& form : forms.all)
    if (form.identity == law.option) return &form.description;
  return nullptr;
}

InitialPoint initial_point(const Description& d, std::span<const double> theta,
                           const InitialConditions& given) {
  const Layout at = layout_of(d);
  const double rho_0 = theta[at.rho_0()],
               rho_p = d.has_grain_density ? theta[at.rho_p()] : std::nan("");
  const bool takes_v = d.void_ratio_statev > 0 || !std::isnan(rho_p);
  if (given.v && !takes_v)
    throw InputError("v",
                     "a umat has no void ratio of its own: law.void_ratio_statev says which of its "
                     "state variables is one, or law.rho_p makes a density of it");
  reject_unused(law_name, given, false, takes_v);
  InitialPoint point;
  point.stress = initial_stress(given, 0.0);
  point.state.assign(at.nstatv + own_state_count, 0.0);
  std::copy(d.initial_statev.begin(), d.initial_statev.end(), point.state.begin());
  if (given.v && d.void_ratio_statev > 0)
    point.state[static_cast<std::size_t>(d.void_ratio_statev) - 1] = *given.v - 1.0;
  point.density = rho_0;
  if (given.v && !std::isnan(rho_p)) point.density = rho_p / *given.v;
  if (given.density) {
    if (given.v && !std::isnan(rho_p))
      throw InputError("density", "give either v (or e) or density: with rho_p one is the other");
    point.density = *given.density;
  }
  return point;
}

}  // namespace repose::umat
