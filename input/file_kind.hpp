#pragma once

#include "input/input_file.hpp"

namespace repose::input {

/// What an input file describes; its tables tell.
enum class FileKind { scene, point_test, fit, stability, benchmark };

/// [scene], [test], [fit], [stability] or [case]. Throws BadInput if none of them, or several, are
/// there.
FileKind kind_of(const InputFile& file);

/// Throws BadInput unless the file is of the kind that `verb` takes, naming the verb that takes it.
void require_kind(const InputFile& file, FileKind wanted, std::string_view verb);

}  // namespace repose::input
