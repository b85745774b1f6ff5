#pragma once
/// \file
/// A law written as a function of plain arrays, for programs that bring one along without
/// compiling it: the Material around it rotates, strains, takes failed points back and counts the
/// work, as LawMaterial does around a law of templates.

#include <span>
#include <vector>

#include "models/material.hpp"

namespace repose {

/// Points as a BatchLaw sees them: component k of point i stands at [k · count + i].
struct PointArrays {
  std::size_t count = 0;
  std::size_t components = 0;       ///< of stress and strain: 4 or 6, in the order of Sym
  double dt = 0.0;                  ///< [s]
  std::span<const double> strain;   ///< Δε, tension positive; empty where none is asked about
  std::span<const double> density;  ///< at the end of the step [kg/m³]
  std::span<double> stress;         ///< already turned with the material [Pa]
  std::span<double> state;          ///< variables in table order
};

class BatchLaw : public Material {
 public:
  const LawInfo& law() const override { return info_; }

  UpdateReport update(const Batch& batch) const override;
  UpdateReport update(const SpatialBatch& batch) const override;
  void stored_energy(const Batch& batch, double* energy) const override;
  void stored_energy(const SpatialBatch& batch, double* energy) const override;
  void modulus(const Batch& batch, double* rho_c2) const override;
  void modulus(const SpatialBatch& batch, double* rho_c2) const override;
  /// Throws InputError: such a law says nothing of it, so its pressures cannot be averaged.
  void elastic_volume_strain(const Batch& batch, double* strain) const override;
  /// Throws InputError: such a law acts by explicit forces alone.
  void viscosity(const Batch& batch, double* eta, double* thinning) const override;

 protected:
  BatchLaw(const LawInfo& info, std::vector<double> theta)
      : Material(std::move(theta)),
        info_(info) {}

 private:
  /// Brings stress and state to the end of the step. A point left with anything that is not a
  /// finite number counts as failed, and is put back to what it was.
  virtual void advance(const PointArrays& points) const = 0;
  /// ρc² of each point [Pa].
  virtual void wave_modulus(const PointArrays& points, double* rho_c2) const = 0;
  /// Shear viscosity that limits an explicit step at the strain rate strain/dt [Pa s].
  virtual void step_viscosity(const PointArrays& points, double* eta) const = 0;
  /// Recoverable energy per current volume [J/m³].
  virtual void energy(const PointArrays& points, double* stored) const = 0;

  template <int N>
  UpdateReport update_all(const BatchOf<N>& batch) const;
  template <int N, class F>
  void ask(const BatchOf<N>& batch, double* answer, F&& question) const;

  const LawInfo& info_;
};

}  // namespace repose
