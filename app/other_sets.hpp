#pragma once
/// \file
/// One command for all machines: a package holds the program several times, compiled for one
/// instruction set each, and the one that is called hands over to the fastest that the machine has.

#include <string>
#include <vector>

namespace repose::app {

/// An instruction set, and the folder under lib/repose that its program is installed in.
struct InstructionSet {
  const char* name;   ///< as models/instruction_set.hpp says it
  const char* level;  ///< of the x86-64 psABI, or -march of another processor
  bool here;          ///< this machine has it
};
/// The fastest first.
std::vector<InstructionSet> instruction_sets();

/// Takes `--instruction-set NAME` from the arguments (first in line) and, where another program
/// than this one is meant, becomes that: the one asked for, else the fastest beside this one that
/// the machine has. Returns what is wrong with what was asked for, or nothing to go on with.
std::string hand_over(int& argc, char** argv);

}  // namespace repose::app
