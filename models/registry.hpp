#pragma once
/// \file
/// The laws by name: what input files and the programs around a law need, the library's own and
/// those that another program registers. all_laws.hpp has the types of the library's.

#include <cstddef>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "models/ill_posedness.hpp"
#include "models/material.hpp"

namespace repose {

/// A law as an input file writes it.
struct LawSpec {
  std::string name;
  std::map<std::string, std::string> options;  ///< option key → value, e.g. form = "regularised"
  std::map<std::string, double> values;        ///< parameter → value in SI units
};

/// The forms of all laws at one moment: the library's in the order of AllLaws (all_laws.hpp), then
/// those registered from outside by name, whatever the order of their registration. The entries
/// stay where they are until the program ends.
class LawList {
 public:
  class Iterator {
   public:
    using value_type = LawInfo;
    using difference_type = std::ptrdiff_t;
    using reference = const LawInfo&;
    using pointer = const LawInfo*;
    using iterator_category = std::forward_iterator_tag;
    Iterator() = default;
    explicit Iterator(const LawInfo* const* at) : at_(at) {}
    reference operator*() const { return **at_; }
    pointer operator->() const { return *at_; }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    Iterator operator++(int) { return Iterator(at_++); }
    friend bool operator==(const Iterator&, const Iterator&) = default;

   private:
    const LawInfo* const* at_ = nullptr;
  };

  explicit LawList(std::shared_ptr<const std::vector<const LawInfo*>> laws)
      : laws_(std::move(laws)) {}
  Iterator begin() const { return Iterator(laws_->data()); }
  Iterator end() const { return Iterator(laws_->data() + laws_->size()); }
  std::size_t size() const { return laws_->size(); }
  const LawInfo& operator[](std::size_t i) const { return *(*laws_)[i]; }

 private:
  std::shared_ptr<const std::vector<const LawInfo*>> laws_;
};
LawList all_laws();

/// The forms of the library's own laws alone.
std::span<const LawInfo> library_laws();

/// The form of `name` that applies if its option is left out, or null if the option is required.
const LawInfo* default_form(std::string_view name);

/// Derives the values of absent (NaN) optional parameters where the law knows how, and checks
/// conditions between parameters. Throws InputError.
void complete_parameters(const LawInfo& law, std::vector<double>& theta);

/// Finds the form, checks and completes the parameters. Throws InputError; its key is a parameter's
/// or option's name, or "name".
const LawInfo& find_law(const LawSpec& spec);
std::vector<double> checked_parameters(const LawSpec& spec);
std::unique_ptr<Material> make_material(const LawSpec& spec);

/// What a room above this one needs beyond the Material to do with a law from outside; the room
/// derives a class of its own (pointdriver/integrate/outside_driver.hpp).
class OutsideExtension {
 public:
  virtual ~OutsideExtension();
  OutsideExtension() = default;
  OutsideExtension(const OutsideExtension&) = delete;
  OutsideExtension& operator=(const OutsideExtension&) = delete;
};

/// A form of a law that another program brings along. register_law.hpp makes it of a law's type.
struct OutsideLaw {
  const LawInfo* info = nullptr;  ///< lives until the program ends
  std::function<void(std::vector<double>& theta)> complete;
  std::function<std::unique_ptr<Material>(std::vector<double> theta)> make;
  /// The response to steady shear (ill_posedness.hpp); null for a law without such a stress.
  std::function<ShearResponse(std::span<const double> theta, double p, double gamma_dot)>
      shear_response;
  std::shared_ptr<const OutsideExtension> point;  ///< for the point driver; null: it has none
};

/// Makes the forms of one law known under their name to everything that takes a LawSpec: the first
/// is the one that applies if the option is left out. From any thread, at any time. Throws
/// InputError (key "name"), and registers nothing, where the name is empty or taken, the forms
/// differ in name or option_key or agree in their option, a table names something twice or there
/// are more than most_state_variables (material.hpp) state variables.
void register_law(const std::vector<OutsideLaw>& forms);

/// Adds a form to a law from outside, or registers it as the first. For laws whose forms come with
/// the input that names them (umat/in). Throws as register_law() does; nothing changes where the
/// option is known already, so the first form of an option stays.
void register_form(const OutsideLaw& form);

/// The form from outside that belongs to `law`; null for a law of the library's own. Throws
/// InputError (key "name") for one that is neither: it was never registered.
const OutsideLaw* find_outside(const LawInfo& law);

}  // namespace repose
