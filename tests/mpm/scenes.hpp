#pragma once
/// \file
/// Laws and scenes that several tests of the solver start from.

#include <cmath>
#include <numbers>
#include <string>

#include "mpm/step/simulation.hpp"

namespace repose::mpm {

/// p = K[(ρ/ρ_0)^α − 1]; with `carried` the fluid holds together under tension.
inline LawSpec newtonian(double eta, double K, double alpha, double rho_0, bool carried = false) {
  return {"newtonian",
          {{"tension_cutoff", carried ? "false" : "true"}},
          {{"eta", eta}, {"K", K}, {"alpha", alpha}, {"rho_0", rho_0}}};
}

/// The paper's μ(I) grains (physics.md, "The paper's scenes" (b)), elasto-viscoplastic by default.
inline LawSpec mu_i(double K = 254800.0, const char* form = "elastoviscoplastic") {
  return {"mu_i",
          {{"form", form}},
          {{"mu_0", 0.3819},
           {"mu_d", 0.5718},
           {"I_0", 0.279},
           {"d", 0.0053},
           {"rho_p", 2000.0},
           {"rho_0", 1300.0},
           {"K", K}}};
}

/// Grains of which no pile can yield (μ = 10): as good as a stiff elastic body, but without
/// tension.
inline LawSpec unyielding(double K = 1e6) {
  LawSpec law = mu_i(K);
  law.values["mu_0"] = law.values["mu_d"] = 10.0;
  return law;
}

/// The paper's Cam-Clay (physics.md, "The paper's scenes" (a)).
inline LawSpec cam_clay(const char* compression = "ln_v-ln_p") {
  return {"modified_cam_clay",
          {{"compression", compression}},
          {{"M", 0.6614},
           {"lambda", 0.0186},
           {"kappa", 0.0010},
           {"nu", 0.3},
           {"Gamma", 1.0 / 0.648},
           {"p_ref", 1.0},
           {"rho_p", 2000.0}}};
}

/// Cam-Clay at rest and the paper's grains in flow, in one law (physics.md, CSM-5).
inline LawSpec critical_state(double I_v = 0.5) {
  LawSpec law = cam_clay();
  law.name = "critical_state_mu_i";
  law.options.clear();
  law.values.insert({{"M_inf", 0.9904}, {"I_M", 0.1611}, {"I_v", I_v}, {"d", 0.0053}});
  return law;
}

inline Body block(double x, double y, double width, double height, LawSpec law) {
  Body body;
  body.origin = {x, y};
  body.size = {width, height};
  body.law = std::move(law);
  if (body.law.name == "modified_cam_clay" || body.law.name == "critical_state_mu_i") {
    body.initial.p = 2.27;
    body.initial.ocr = 1.0;
  }
  return body;
}

/// An empty box without gravity, slip walls all around.
inline Scene empty_box(double width, double height, double h) {
  Scene scene;
  scene.name = "test";
  scene.domain = {width, height};
  scene.h = h;
  scene.gravity = 0.0;
  scene.floor = scene.left = scene.right = scene.top = {Wall::Kind::slip};
  scene.end_time = 1.0;
  scene.transfer = Transfer::apic;
  scene.courant = 0.4;
  return scene;
}

/// The paper's collapse on a grid of half its resolution (or h), 2048 points.
inline Scene column_collapse(const LawSpec& law, double h = 0.0125) {
  Scene scene = empty_box(1.2, 0.5625, h);
  scene.gravity = 9.8;
  scene.floor = {Wall::Kind::no_slip};
  scene.bodies = {block(0.0, 0.0, 0.2, 0.4, law)};
  return scene;
}

inline void run_until(Simulation& simulation, double time) {
  while (simulation.time() < time) simulation.step(time);
}

inline void run_steps(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) simulation.step(HUGE_VAL);
}

}  // namespace repose::mpm
