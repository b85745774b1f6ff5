#include "pointdriver/path/history.hpp"

#include <cmath>
#include <cstdio>

#include "models/parameter.hpp"

namespace repose::point {
namespace {

[[noreturn]] void fail(const std::string& name, int line, const std::string& what) {
  throw TableError(name + ":" + std::to_string(line) + ": " + what);
}

std::string text_of(double x) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", x);
  return text.data();
}

/// A column's meaning: one constraint row per entry, scaled to SI.
struct Prescribed {
  std::vector<Constraint> rows;
  double factor = 1.0;
};

struct Unit {
  std::string_view suffix;
  double factor;
};

/// "sigma_yy_kPa" → ("sigma_yy", 1e3)
std::pair<std::string, double> split_unit(const std::string& column) {
  for (const Unit unit :
       {Unit{"_kPa", 1e3}, Unit{"_MPa", 1e6}, Unit{"_Pa", 1.0}, Unit{"_percent", 1e-2}})
    if (column.ends_with(unit.suffix))
      return {column.substr(0, column.size() - unit.suffix.size()), unit.factor};
  return {column, 0.0};
}

Constraint sum_of(std::initializer_list<int> components, double weight, bool stress) {
  Constraint row;
  for (const int i : components)
    (stress ? row.stress : row.strain)[static_cast<std::size_t>(i)] = weight;
  return row;
}

Prescribed meaning(const Table& table, const std::string& column) {
  const auto [name, unit] = split_unit(column);
  const bool stress = name.starts_with("sigma_") || name == "tau";
  const auto bad = [&](const std::string& why) -> void { fail(table.name, 1, why); };
  if (stress && (unit == 0.0 || unit == 1e-2))
    bad("column " + column + " needs a unit of stress in its name: " + name + "_Pa or " + name +
        "_kPa");
  if (!stress && unit >= 1.0)
    bad("column " + column + " is a strain: give " + name + " (no unit) or " + name + "_percent");
  Prescribed p;
  p.factor = unit == 0.0 ? 1.0 : unit;
  const std::string component = name.substr(name.find('_') + 1);
  if (const int i = component_index(component);
      i >= 0 && (name.starts_with("eps_") || name.starts_with("sigma_"))) {
    p.rows = {stress ? stress_rate(i, 0.0) : strain_rate(i, 0.0)};
  } else if (name == "eps_a") {
    p.rows = {strain_rate(1, 0.0)};
  } else if (name == "eps_r") {
    p.rows = {strain_rate(0, 0.0), strain_rate(2, 0.0)};
  } else if (name == "eps_v") {
    p.rows = {sum_of({0, 1, 2}, 1.0, false)};
  } else if (name == "gamma") {
    p.rows = {sum_of({3}, 2.0, false)};
  } else if (name == "sigma_a") {
    p.rows = {stress_rate(1, 0.0)};
  } else if (name == "sigma_r") {
    p.rows = {sum_of({0, 2}, 0.5, true), equal_strain(0, 2)};
    p.rows[1].rate = std::numeric_limits<double>::quiet_NaN();  // a row without its own value
  } else if (name == "tau") {
    p.rows = {stress_rate(3, 0.0)};
  } else {
    const std::array<std::string_view, 12> known{
        "eps_xx", "eps_yy",     "eps_zz",     "eps_a",  "eps_r",       "eps_v",
        "gamma",  "sigma_a_Pa", "sigma_r_Pa", "tau_Pa", "sigma_yy_Pa", "time_s"};
    const std::string near = nearest_name(column, known);
    bad("column \"" + column + "\" is nothing that a history can prescribe" +
        (near.empty() ? "" : "; did you mean \"" + near + "\"?"));
  }
  return p;
}

bool involves(const std::vector<std::pair<Constraint, std::size_t>>& rows, std::size_t component) {
  for (const auto& [row, column] : rows)
    if (row.strain[component] != 0.0 || row.stress[component] != 0.0) return true;
  return false;
}

/// What a column holds in SI and logarithmic strain.
std::vector<double> column_values(const Table& table, std::size_t c, const Prescribed& p,
                                  StrainMeasure measure, double max_strain) {
  std::vector<double> values = table.values[c];
  const std::string& column = table.columns[c];
  const bool stress = p.rows[0].stress != std::array<double, 6>{};
  const bool normal = !stress && column.find("xy") == std::string::npos &&
                      column.find("yz") == std::string::npos &&
                      column.find("zx") == std::string::npos && !column.starts_with("gamma");
  for (std::size_t k = 0; k < values.size(); ++k) {
    double& x = values[k];
    x *= p.factor;
    if (stress) continue;
    if (!(std::abs(x) <= max_strain))
      fail(table.name, table.lines[k],
           column + " = " + text_of(x) + " is a strain of " + text_of(100.0 * x) +
               " %, beyond integration.max_strain = " + text_of(max_strain) +
               (p.factor == 1.0 ? ": a column in per cent is named " + column + "_percent"
                                : std::string()));
    if (measure == StrainMeasure::engineering && normal) {
      if (!(x < 1.0))
        fail(table.name, table.lines[k],
             column + " = " + text_of(x) + ": an engineering strain is below 1 (100 %)");
      x = -std::log1p(-x);
    }
  }
  return values;
}

}  // namespace

Path history_path(const Table& table, HistoryIs is, StrainMeasure measure, double max_strain) {
  const auto time = std::find(table.columns.begin(), table.columns.end(), "time_s");
  if (time == table.columns.end()) throw TableError(table.name + ": column time_s is missing");
  const auto time_column = static_cast<std::size_t>(time - table.columns.begin());
  const auto& t = table.values[time_column];
  if (t.size() < 2) throw TableError(table.name + ": a history needs at least two rows");

  std::vector<std::pair<Constraint, std::size_t>> rows;  // with the column that drives it
  std::vector<std::vector<double>> values(table.columns.size());
  std::vector<StartClaim> claims;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (c == time_column) continue;
    const Prescribed p = meaning(table, table.columns[c]);
    values[c] = column_values(table, c, p, measure, max_strain);
    for (const Constraint& row : p.rows) rows.emplace_back(row, c);
    double largest = 0.0;
    for (const double x : values[c]) largest = std::max(largest, std::abs(x));
    if (is == HistoryIs::absolute)
      claims.push_back({p.rows[0], values[c][0], 1e-4 * largest, table.columns[c],
                        table.name + ":" + std::to_string(table.lines[0])});
  }
  for (std::size_t shear = 3; shear < 6; ++shear)
    if (!involves(rows, shear)) {
      Constraint row = strain_rate(static_cast<int>(shear), 0.0);
      row.rate = std::numeric_limits<double>::quiet_NaN();
      rows.emplace_back(row, time_column);
    }
  if (rows.size() != 6)
    throw TableError(table.name + ": the columns prescribe " + std::to_string(rows.size()) +
                     " components (shear that is not named counts as none), and six are needed: "
                     "for an axisymmetric test two of eps_a, eps_r, eps_v, sigma_a_Pa, sigma_r_Pa, "
                     "where eps_r and sigma_r count twice");

  std::vector<LegSpec> legs;
  legs.reserve(t.size() - 1);
  for (std::size_t k = 0; k + 1 < t.size(); ++k) {
    const double dt = t[k + 1] - t[k];
    if (!(dt > 0.0)) fail(table.name, table.lines[k + 1], "time_s must grow from row to row");
    LegSpec leg;
    leg.duration = dt;
    leg.name = "history (row " + std::to_string(k + 2) + ")";
    for (std::size_t r = 0; r < 6; ++r) {
      const auto& [row, column] = rows[r];
      leg.rows[r] = row;
      leg.rows[r].rate =
          std::isnan(row.rate) ? 0.0 : (values[column][k + 1] - values[column][k]) / dt;
    }
    legs.push_back(std::move(leg));
  }
  Path path;
  path.measure = measure;
  path.start_claims = std::move(claims);
  path.wants_strain_rate = true;
  const bool shears =
      involves({rows.begin(), rows.end()}, 3) &&
      std::any_of(table.columns.begin(), table.columns.end(), [](const auto& name) {
        return name.find("xy") != std::string::npos || name == "gamma" || name.starts_with("tau");
      });
  path.frame = shears ? Frame::shear : Frame::axisymmetric;
  path.legs.reserve(legs.size());
  try {
    for (LegSpec& leg : legs) path.legs.emplace_back(std::move(leg));
  } catch (const InputError& error) {
    throw TableError(table.name + ": the columns do not determine the path: " + error.what());
  }
  return path;
}

}  // namespace repose::point
