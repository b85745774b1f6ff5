#include "study/point/laboratory_record.hpp"

#include <cmath>

#include <fmt/format.h>

namespace repose::study {
namespace {

using io::Json;
using point::After;
using point::CompressionBranch;
using Way = CompressionBranch::Way;

const char* word(After after) {
  switch (after) {
    case After::peak:
      return "peak";
    case After::plateau:
      return "plateau";
    case After::rising:
      return "still rising";
  }
  return "";
}

const char* word(Way way) {
  switch (way) {
    case Way::virgin:
      return "virgin";
    case Way::unloading:
      return "unloading";
    case Way::reloading:
      return "reloading";
  }
  return "";
}

void add(Json& to, const char* key, double x) {
  if (std::isfinite(x)) to[key] = x;
}

/// The last branch of a kind; null if there is none.
const CompressionBranch* last(const point::LaboratoryFigures& figures, Way way) {
  const CompressionBranch* found = nullptr;
  for (const CompressionBranch& b : figures.compression)
    if (b.way == way) found = &b;
  return found;
}

/// Why C_s is not κ ln 10; empty where it is, or where the law has no κ.
std::string swelling_note(const CompressionBranch& b, bool oedometer) {
  if (!std::isfinite(b.C_over_kappa) || std::abs(b.C_over_kappa - 1.0) < 0.02) return "";
  if (oedometer && std::abs(b.C_over_kappa - b.p_over_x) < 0.02 * b.C_over_kappa)
    return fmt::format(
        "C_s is {:.2f} kappa ln 10: K0 changes on the way (to {:.2f} at its end), so that ln p' "
        "changes {:.2f} times as much as ln sigma'_a, and kappa belongs to p'",
        b.C_over_kappa, b.K0, b.p_over_x);
  return fmt::format("C_s is {:.2f} kappa ln 10: the branch is not elastic throughout",
                     b.C_over_kappa);
}

void add_compression(Json& s, const point::LaboratoryFigures& figures) {
  if (figures.compression.empty()) return;
  if (const CompressionBranch* virgin = last(figures, Way::virgin)) {
    if (figures.oedometer) add(s, "K0_nc", virgin->K0);
    add(s, "C_c", virgin->C);
  }
  if (const CompressionBranch* unloading = last(figures, Way::unloading)) {
    add(s, "C_s", unloading->C);
    if (std::string note = swelling_note(*unloading, figures.oedometer); !note.empty())
      s["C_s_note"] = note;
  }
  Json list = Json::array();
  for (const CompressionBranch& b : figures.compression) {
    Json row{{"stage", b.stage}, {"way", word(b.way)}};
    const char* const x = figures.oedometer ? "sigma_a" : "p";
    row[fmt::format("{}_from_Pa", x)] = b.from;
    row[fmt::format("{}_to_Pa", x)] = b.to;
    add(row, "C", b.C);
    add(row, "C_over_kappa_ln_10", b.C_over_kappa);
    if (figures.oedometer) add(row, "K0", b.K0);
    add(row, "OCR", b.OCR);
    list.push_back(std::move(row));
  }
  s["compression"] = std::move(list);
}

}  // namespace

Json laboratory_json(const point::LaboratoryFigures& figures) {
  Json s = Json::object();
  if (const auto& u = figures.undrained) {
    s["S_u_Pa"] = u->S_u;
    s["S_u_strain"] = u->strain;
    s["S_u_is"] = word(u->after);
    s["S_u_stage"] = u->stage;
    add(s, "A_f", u->A_f);
  }
  if (const auto& f = figures.friction) {
    s["phi_peak_deg"] = f->peak;
    s["phi_peak_strain"] = f->strain;
    s["phi_peak_is"] = word(f->after);
    s["phi_peak_stage"] = f->stage;
    add(s, "phi_end_deg", f->end);
    if (f->tension)
      s["phi_note"] =
          "sigma'_3 falls below zero on the way: in tension no friction angle is defined, "
          "and the rows there are left out";
    if (std::isfinite(f->critical)) {
      s["phi_critical_deg"] = f->critical;
      s["phi_critical_b"] = f->b;
    }
    add(s, "phi_on_plane_deg", f->on_plane);
  }
  if (const auto& e = figures.stiffness) {
    s["E50_Pa"] = e->E50;
    s["E50_eps_a"] = e->eps_a;
    s["E50_stage"] = e->stage;
  }
  if (!figures.secants.empty()) {
    Json list = Json::array();
    for (const point::SecantShear& g : figures.secants)
      list.push_back(Json{{"stage", g.stage}, {"gamma", g.gamma}, {"G_Pa", g.G}});
    s["secant_G"] = std::move(list);
  }
  add_compression(s, figures);
  return s;
}

std::string laboratory_line(const point::LaboratoryFigures& figures) {
  std::vector<std::string> parts;
  if (const auto& u = figures.undrained) {
    parts.push_back(fmt::format("S_u = {:.4g} kPa at a strain of {:.3g} % ({})", 1e-3 * u->S_u,
                                100.0 * u->strain, word(u->after)));
    if (std::isfinite(u->A_f)) parts.push_back(fmt::format("A_f = {:.3g}", u->A_f));
  }
  if (const auto& f = figures.friction) {
    std::string text = fmt::format("φ' = {:.1f}°", f->peak);
    if (f->after != After::plateau) text += fmt::format(" ({})", word(f->after));
    if (f->after == After::peak && std::isfinite(f->end))
      text += fmt::format(", {:.1f}° at the end", f->end);
    if (f->tension) text += ", sigma'_3 < 0 on the way";
    if (std::isfinite(f->critical)) text += fmt::format(", critical {:.1f}°", f->critical);
    parts.push_back(std::move(text));
  }
  if (const auto& e = figures.stiffness)
    parts.push_back(fmt::format("E50 = {:.4g} MPa", 1e-6 * e->E50));
  if (const CompressionBranch* virgin = last(figures, Way::virgin)) {
    if (figures.oedometer) parts.push_back(fmt::format("K0 = {:.3g}", virgin->K0));
    if (std::isfinite(virgin->C)) parts.push_back(fmt::format("C_c = {:.3g}", virgin->C));
  }
  if (const CompressionBranch* unloading = last(figures, Way::unloading)) {
    if (std::isfinite(unloading->C)) parts.push_back(fmt::format("C_s = {:.3g}", unloading->C));
    if (figures.oedometer)
      parts.push_back(fmt::format("K0 = {:.3g} at {}", unloading->K0,
                                  std::isfinite(unloading->OCR)
                                      ? fmt::format("OCR {:.3g}", unloading->OCR)
                                      : "the end of unloading"));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace repose::study
