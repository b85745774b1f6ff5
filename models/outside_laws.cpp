/// The laws that other programs have registered.
#include <algorithm>
#include <deque>
#include <mutex>
#include <set>

#include "models/registry.hpp"

namespace repose {
namespace {

/// Nothing that was registered is ever changed or given up, so a reader holds the lock no longer
/// than it takes to copy a pointer.
class Registry {
 public:
  static Registry& instance() {
    static Registry* const only = new Registry;  // laws may be asked for until the very end
    return *only;
  }

  LawList list() const {
    const std::lock_guard lock(mutex_);
    return LawList(list_);
  }

  const OutsideLaw* find(const LawInfo& law) const {
    const std::lock_guard lock(mutex_);
    return find_locked(law);
  }

  /// False if the name is taken.
  bool add(const std::vector<OutsideLaw>& forms) {
    const std::lock_guard lock(mutex_);
    if (laws_.contains(forms.front().info->name)) return false;
    laws_.emplace(forms.front().info->name, Forms(forms.begin(), forms.end()));
    list_ = listed();
    return true;
  }

  /// A further form of a law that may be new.
  void add_form(const OutsideLaw& form) {
    const std::lock_guard lock(mutex_);
    if (find_locked(*form.info) != nullptr) return;
    laws_[std::string(form.info->name)].push_back(form);
    list_ = listed();
  }

 private:
  using Forms = std::deque<OutsideLaw>;  // what find() gave stays where it is

  Registry() : list_(listed()) {}

  const OutsideLaw* find_locked(const LawInfo& law) const {
    const auto found = laws_.find(law.name);
    if (found == laws_.end()) return nullptr;
    for (const OutsideLaw& form : found->second)
      if (form.info->option == law.option) return &form;
    return nullptr;
  }

  std::shared_ptr<const std::vector<const LawInfo*>> listed() const {
    auto list = std::make_shared<std::vector<const LawInfo*>>();
    for (const LawInfo& info : library_laws()) list->push_back(&info);
    for (const auto& [name, forms] : laws_)
      for (const OutsideLaw& form : forms) list->push_back(form.info);
    return list;
  }

  mutable std::mutex mutex_;
  std::map<std::string, Forms, std::less<>> laws_;
  std::shared_ptr<const std::vector<const LawInfo*>> list_;
};

bool is_library_law(std::string_view name, std::string_view option) {
  return std::any_of(library_laws().begin(), library_laws().end(), [&](const LawInfo& info) {
    return info.name == name && info.option == option;
  });
}

/// "" where all entries of a table have names of their own, else what is wrong.
template <class Table>
std::string fault_of(const Table& table) {
  std::set<std::string_view> names;
  for (const auto& entry : table) {
    if (entry.name.empty()) return "an entry without a name";
    if (!names.insert(entry.name).second) return "\"" + std::string(entry.name) + "\" twice";
  }
  return "";
}

}  // namespace

OutsideExtension::~OutsideExtension() = default;

LawList all_laws() { return Registry::instance().list(); }

const OutsideLaw* find_outside(const LawInfo& law) {
  if (const OutsideLaw* found = Registry::instance().find(law)) return found;
  if (is_library_law(law.name, law.option)) return nullptr;
  throw InputError("name", "the law \"" + std::string(law.name) +
                               (law.option.empty() ? "" : "\", \"" + std::string(law.option)) +
                               "\" is unknown: it was never registered (register_law.hpp)");
}

namespace {

/// Throws InputError where the forms are not those of one law.
void check_forms(const std::vector<OutsideLaw>& forms) {
  if (forms.empty()) throw InputError("name", "register_law: no form of a law was given");
  const auto complete = [](const OutsideLaw& form) {
    return form.info != nullptr && form.complete && form.make;
  };
  if (!std::all_of(forms.begin(), forms.end(), complete))
    throw InputError("name", "register_law: a form needs info, complete and make");
  const LawInfo& first = *forms.front().info;
  const std::string name(first.name);
  const auto fail = [&](const std::string& what) {
    throw InputError("name", "register_law: the law \"" + name + "\" " + what);
  };
  if (name.empty()) throw InputError("name", "register_law: a law needs a name");
  std::set<std::string_view> options;
  for (const OutsideLaw& form : forms) {
    const LawInfo& info = *form.info;
    if (info.name != first.name)
      fail("and \"" + std::string(info.name) + "\" are two laws: register each by itself");
    if (info.option_key != first.option_key)
      fail("has forms with different option keys, \"" + std::string(first.option_key) +
           "\" and \"" + std::string(info.option_key) + "\"");
    if (!options.insert(info.option).second)
      fail("has two forms with the option \"" + std::string(info.option) + "\"");
    if (info.option.empty() != info.option_key.empty())
      fail("needs both an option and its key, or neither");
    if (const std::string fault = fault_of(info.parameters); !fault.empty())
      fail("has in its table of parameters " + fault);
    if (const std::string fault = fault_of(info.state); !fault.empty())
      fail("has in its table of state variables " + fault);
    if (info.state.size() > most_state_variables)
      fail("has " + std::to_string(info.state.size()) + " state variables; there is room for " +
           std::to_string(most_state_variables));
  }
  const auto library = library_laws();
  if (std::any_of(library.begin(), library.end(),
                  [&](const LawInfo& info) { return info.name == name; }))
    fail("is one of the library's own: take another name");
}

}  // namespace

void register_law(const std::vector<OutsideLaw>& forms) {
  check_forms(forms);
  if (!Registry::instance().add(forms))
    throw InputError("name", "register_law: the law \"" + std::string(forms.front().info->name) +
                                 "\" is registered already: a name stands for one law as long as "
                                 "the program runs");
}

void register_form(const OutsideLaw& form) {
  check_forms({form});
  Registry::instance().add_form(form);
}

}  // namespace repose
