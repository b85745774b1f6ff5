#include "tests/fuzz/corpus_replay.hpp"

namespace {

TEST(ShapeReplay, EveryFileOfTheCorpusItsCutsAndItsChanges) {
  replay_corpus("shape", "0123456789.-+eE,;[]\n nacN\xff", 5);
}

}  // namespace
