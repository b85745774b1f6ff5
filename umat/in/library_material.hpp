#pragma once
/// \file
/// The Material of a foreign UMAT: batches of points go to a process that runs the library.

#include "umat/in/library_law.hpp"

namespace repose::umat {

class LibraryMaterial final : public Material {
 public:
  LibraryMaterial(const LawInfo& info, const Description& description, std::vector<double> theta)
      : Material(std::move(theta)),
        info_(info),
        description_(description),
        at_(layout_of(description)) {}

  const LawInfo& law() const override { return info_; }

  UpdateReport update(const Batch& batch) const override { return update_all(batch); }
  UpdateReport update(const SpatialBatch& batch) const override { return update_all(batch); }

  /// SSE: 0 where the library does not say.
  void stored_energy(const Batch& batch, double* energy) const override {
    stored_in(batch, energy);
  }
  void stored_energy(const SpatialBatch& batch, double* energy) const override {
    stored_in(batch, energy);
  }

  /// Of the last update; before the first, from the DDSDDE that the library gives for a small
  /// isotropic compression.
  void modulus(const Batch& batch, double* rho_c2) const override { modulus_of(batch, rho_c2); }
  void modulus(const SpatialBatch& batch, double* rho_c2) const override {
    modulus_of(batch, rho_c2);
  }

  /// The whole volume strain since the start: a UMAT does not say what of it is elastic.
  void elastic_volume_strain(const Batch& batch, double* strain) const override;
  /// None: a UMAT remembers its stress.
  void viscosity(const Batch& batch, double* eta, double* thinning) const override;

  /// Throws InputError: "rho_0" where the density is not known, "law" where the library fails at
  /// rest or has no stiffness there.
  InitialPoint initial(const InitialConditions& given) const override;
  double density_at(double p, double ocr) const override;

 private:
  template <int N>
  UpdateReport update_all(const BatchOf<N>& batch) const;
  template <int N>
  void update_part(const BatchOf<N>& batch, std::size_t first, std::size_t count,
                   HostProcess& host) const;
  template <int N>
  void stored_in(const BatchOf<N>& batch, double* energy) const;
  template <int N>
  void modulus_of(const BatchOf<N>& batch, double* rho_c2) const;
  /// Asks for the tangent as the points are. Errors: Failure.
  template <int N>
  void probe(const BatchOf<N>& batch, double* rho_c2) const;
  template <int N>
  void pack(const BatchOf<N>& batch, std::size_t k, const Exchange& exchange, std::size_t i) const;
  double* own(const auto& batch, std::size_t i) const { return batch.state[at_.own(i)]; }
  double density() const;

  const LawInfo& info_;
  const Description& description_;
  Layout at_;
};

}  // namespace repose::umat
