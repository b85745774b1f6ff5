/// \file
/// UMAT, the user material of Abaqus/Standard and of programs that take one like it
/// (docs/umat_out.md). Components are 11, 22, 33, 12, 13, 23, shear strains γ = 2ε, stresses
/// tension positive and already turned with the material; the arrays are Fortran's.

#include <algorithm>
#include <cmath>
#include <cstring>

#include "umat/out/constants.hpp"
#include "umat/out/host.hpp"
#include "umat/out/material_name.hpp"
#include "umat/out/point_update.hpp"

namespace repose::umat {
namespace {

/// By how much the host is to shorten an increment that cannot be done.
constexpr double cut = 0.5;

/// A law with its constants, and what the host called it.
struct Model {
  std::string name;
  std::vector<double> props;
  const LawInfo* law = nullptr;
  std::unique_ptr<PointUpdate> update;
  InitialConditions start;
};

bool same(std::span<const double> a, std::span<const double> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

/// The models that a thread has met last. Each thread has its own, so that none waits for another.
class ModelCache {
 public:
  /// Throws InputError for a name or constants that make no material.
  const Model& find(std::string_view name, std::span<const double> props) {
    if (last_ < models_.size() && is(models_[last_], name, props)) return models_[last_];
    for (std::size_t i = 0; i < models_.size(); ++i)
      if (is(models_[i], name, props)) return models_[last_ = i];
    Model model = make(name, props);
    if (models_.size() < most) {
      last_ = models_.size();
      models_.push_back(std::move(model));
    } else {
      last_ = oldest_;
      oldest_ = (oldest_ + 1) % most;
      models_[last_] = std::move(model);
    }
    return models_[last_];
  }

 private:
  static constexpr std::size_t most = 64;

  static bool is(const Model& model, std::string_view name, std::span<const double> props) {
    return model.name == name && same(model.props, props);
  }
  static Model make(std::string_view name, std::span<const double> props) {
    Model model{std::string(name), {props.begin(), props.end()}, &find_form(name), nullptr, {}};
    const Constants constants = [&] {
      try {
        return read_constants(*model.law, props);
      } catch (const InputError& error) {
        const std::string place = place_of(*model.law, error.key());
        throw InputError(error.key(), (place.empty() ? "" : place + ": ") + error.what());
      }
    }();
    model.update = make_point_update(*model.law, constants.theta);
    model.start = constants.start;
    return model;
  }

  std::vector<Model> models_;
  std::size_t last_ = 0, oldest_ = 0;
};

/// The arguments that are read or written.
struct Arguments {
  double* stress;
  double* statev;
  double* ddsdde;
  double *sse, *spd, *scd;
  const double* dstran;
  double dtime;
  std::string_view cmname;
  int ndi, nshr, ntens, nstatv;
  std::span<const double> props;
};

/// The component of repose (sym.hpp) that stands at place i of the host's.
template <int N>
constexpr int component(int i) {
  return N == 6 && i > 3 ? 9 - i : i;  // 13, 23 are zx, yz
}

std::string state_list(const LawInfo& law) {
  std::string text = "density";
  for (const StateField& field : law.state) text += ", " + std::string(field.name);
  return text;
}

/// A point whose state is not given starts at rest under its stress.
template <int N>
InitialPoint start(const Model& model, const Sym<double, N>& stress) {
  InitialConditions given = model.start;
  std::array<double, 6> compression{};
  for (int k = 0; k < N; ++k) compression[static_cast<std::size_t>(k)] = -stress[k];
  given.sigma = compression;
  try {
    return model.update->initial(given);
  } catch (const InputError& error) {
    const std::string place = place_of(*model.law, error.key());
    throw InputError(error.key(),
                     (place.empty() ? "STRESS at the first call" : place) + ": " + error.what());
  }
}

/// False where the step cannot be done: nothing is changed then.
template <int N>
bool step(const Model& model, const Arguments& a) {
  const LawInfo& law = *model.law;
  const std::size_t states = law.state.size();
  const auto given = static_cast<std::size_t>(std::max(a.nstatv, 0));
  if (given < 1 + states)
    throw InputError("NSTATV", "*DEPVAR must be at least " + std::to_string(1 + states) + " (" +
                                   state_list(law) + "), and is " + std::to_string(a.nstatv));
  Point<N> point;
  Sym<double, N> strain;
  for (int i = 0; i < N; ++i) {
    const int k = component<N>(i);
    point.stress[k] = a.stress[i];
    strain[k] = (i < 3 ? 1.0 : 0.5) * a.dstran[i];
  }
  const std::span<double> kept(a.statev + 1, states);
  std::span<double> state = kept;
  std::vector<double> fresh;
  point.density = a.statev[0];
  point.plastic = *a.spd;
  point.viscous = *a.scd;
  if (point.density == 0.0) {
    if (std::any_of(state.begin(), state.end(), [](double x) { return x != 0.0; }))
      throw InputError("STATEV", "STATEV(1), the density, is 0 and others are not: give all of " +
                                     state_list(law) + ", or none");
    const InitialPoint at_rest = start(model, point.stress);
    for (int k = 0; k < N; ++k) point.stress[k] = at_rest.stress[k];
    point.density = at_rest.density;
    fresh = at_rest.state;
    state = fresh;
  } else if (!(point.density > 0.0)) {
    throw InputError("STATEV", "STATEV(1), the density, is " + std::to_string(point.density) +
                                   " kg/m³: it must be > 0, or 0 for a point that starts");
  }
  const std::size_t room = given - 1 - states;
  const std::span<double> derived(a.statev + 1 + states, std::min(room, law.derived.size()));
  Tangent<N> tangent;
  if (!model.update->advance(strain, a.dtime, point, state, derived, tangent)) return false;
  for (int i = 0; i < N; ++i) {
    const auto k = static_cast<std::size_t>(component<N>(i));
    a.stress[i] = point.stress.c[k];
    for (int j = 0; j < N; ++j)
      a.ddsdde[i + N * j] =
          (j < 3 ? 1.0 : 0.5) * tangent[k][static_cast<std::size_t>(component<N>(j))];
  }
  a.statev[0] = point.density;
  std::copy(fresh.begin(), fresh.end(), kept.begin());
  *a.sse = point.stored;
  *a.spd = point.plastic;
  *a.scd = point.viscous;
  return true;
}

bool step(const Arguments& a) {
  thread_local ModelCache cache;
  const Model& model = cache.find(a.cmname, a.props);
  if (a.ndi == 3 && a.nshr == 3 && a.ntens == 6) return step<6>(model, a);
  if (a.ndi == 3 && a.nshr == 1 && a.ntens == 4) return step<4>(model, a);
  throw InputError("NTENS",
                   "elements must have NDI = 3 and NSHR = 3 (space) or NSHR = 1 (plane "
                   "strain, axisymmetric); these have NDI = " +
                       std::to_string(a.ndi) + ", NSHR = " + std::to_string(a.nshr) +
                       " (plane stress has NDI = 2)");
}

}  // namespace
}  // namespace repose::umat

extern "C" [[gnu::visibility("default")]] void umat_(
    double* stress, double* statev, double* ddsdde, double* sse, double* spd, double* scd,
    double* /*rpl*/, double* /*ddsddt*/, double* /*drplde*/, double* /*drpldt*/,
    const double* /*stran*/, const double* dstran, const double* /*time*/, const double* dtime,
    const double* /*temp*/, const double* /*dtemp*/, const double* /*predef*/,
    const double* /*dpred*/, const char* cmname, const int* ndi, const int* nshr, const int* ntens,
    const int* nstatv, const double* props, const int* nprops, const double* /*coords*/,
    const double* /*drot*/, double* pnewdt, const double* /*celent*/, const double* /*dfgrd0*/,
    const double* /*dfgrd1*/, const int* noel, const int* npt, const int* /*layer*/,
    const int* /*kspt*/, const int* /*kstep*/, const int* /*kinc*/, std::size_t cmname_length) {
  using namespace repose::umat;
  // a host in C may pass no length
  const std::string_view name(cmname, std::min(cmname_length, longest_name));
  bool done = false;
  try {
    done = step({stress,
                 statev,
                 ddsdde,
                 sse,
                 spd,
                 scd,
                 dstran,
                 *dtime,
                 name,
                 *ndi,
                 *nshr,
                 *ntens,
                 *nstatv,
                 {props, static_cast<std::size_t>(std::max(*nprops, 0))}});
  } catch (const std::exception& error) {
    const std::string_view shown = name.substr(0, name.find_last_not_of(' ') + 1);
    stop("repose UMAT, material " + std::string(shown) + ", element " + std::to_string(*noel) +
         ", integration point " + std::to_string(*npt) + ": " + error.what());
  }
  if (!done && !(*pnewdt < cut)) *pnewdt = cut;
}
