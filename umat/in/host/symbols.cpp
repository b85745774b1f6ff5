#include "umat/in/host/symbols.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <fstream>
#include <iterator>

#include <elf.h>
#include <link.h>

namespace repose::umat {
namespace {

/// "UMAT_" and "umat" are both "umat".
std::string plain(const std::string& name) {
  std::string letters;
  for (const char c : name)
    if (c != '_') letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return letters;
}

/// The bytes of a file, from which structures are copied only where they lie within it.
class Image {
 public:
  explicit Image(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(in), {});
  }
  template <class T>
  bool copy(std::size_t offset, T& to) const {
    if (offset > bytes_.size() || bytes_.size() - offset < sizeof(T)) return false;
    std::memcpy(&to, bytes_.data() + offset, sizeof(T));
    return true;
  }
  std::string text(std::size_t offset, std::size_t end) const {
    end = std::min(end, bytes_.size());
    std::string t;
    while (offset < end && bytes_[offset] != '\0') t += bytes_[offset++];
    return t;
  }

 private:
  std::vector<char> bytes_;
};

}  // namespace

std::vector<std::string> exported_functions(const std::string& library) {
  std::vector<std::string> names;
  const Image image(library);
  ElfW(Ehdr) head{};
  if (!image.copy(0, head) || std::memcmp(head.e_ident, ELFMAG, SELFMAG) != 0) return names;
  for (std::size_t k = 0; k < head.e_shnum; ++k) {
    ElfW(Shdr) section{}, strings{};
    if (!image.copy(head.e_shoff + k * head.e_shentsize, section)) return names;
    if (section.sh_type != SHT_DYNSYM || section.sh_entsize == 0) continue;
    if (!image.copy(head.e_shoff + section.sh_link * head.e_shentsize, strings)) return names;
    for (std::size_t i = 0; i < section.sh_size / section.sh_entsize; ++i) {
      ElfW(Sym) symbol{};
      if (!image.copy(section.sh_offset + i * section.sh_entsize, symbol)) return names;
      if (ELF64_ST_TYPE(symbol.st_info) != STT_FUNC || symbol.st_shndx == SHN_UNDEF) continue;
      names.push_back(
          image.text(strings.sh_offset + symbol.st_name, strings.sh_offset + strings.sh_size));
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> similar_symbols(const std::vector<std::string>& functions,
                                         const std::string& wanted) {
  std::vector<std::string> same, containing;
  for (const std::string& name : functions) {
    if (plain(name) == plain(wanted))
      same.push_back(name);
    else if (plain(name).find("umat") != std::string::npos)
      containing.push_back(name);
  }
  same.insert(same.end(), containing.begin(), containing.end());
  if (same.size() > 8) same.resize(8);
  return same;
}

}  // namespace repose::umat
