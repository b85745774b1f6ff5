#include "tests/fuzz/corpus_replay.hpp"

namespace {

TEST(MapReplay, EveryMapOfTheCorpusItsCutsAndItsChanges) {
  replay_corpus("map", "0123456789.-+eE,[]{}\":\n nacN\xff", 6);
}

// What is nested deeply ends in a message, not in the stack's end.
TEST(MapReplay, DeepNesting) {
  for (const int deep : {100, 10000}) {
    std::string json = "\1";
    for (int k = 0; k < deep; ++k) json += R"({"type":"Feature","geometry":)";
    json += "null";
    json.append(static_cast<std::size_t>(deep), '}');
    EXPECT_EQ(replay(json), 0);
    EXPECT_EQ(replay("\1" + std::string(static_cast<std::size_t>(deep), '[')), 0);
  }
}

}  // namespace
