// Recordings: MCAP files as Reader takes them.
#include "common/mcap/reader.h"
#include "tests/fuzz/targets.h"

namespace bevloc::fuzz {

void run_mcap(Bytes bytes) {
  const auto reader = mcap::Reader::parse(text_of(bytes), "input");
  if (!reader) {
    expect(!reader.error().message.empty(), "an error without a message");
    return;
  }
  size_t read = 0;
  for (size_t i = 0; i < reader->chunks().size() && i < 64; ++i) {
    const auto chunk = reader->read_chunk(i);
    expect(chunk || reader->complete(), "a scanned chunk that cannot be read");
    if (!chunk) continue;
    const char* const begin = chunk->bytes.data();
    for (const mcap::Message& message : chunk->messages) {
      expect(message.data.data() >= begin &&
                 message.data.data() + message.data.size() <= begin + chunk->bytes.size(),
             "a message outside of its chunk");
      read += message.data.size();
    }
  }
  static volatile size_t total = 0;
  total = total + read;
}

}  // namespace bevloc::fuzz
