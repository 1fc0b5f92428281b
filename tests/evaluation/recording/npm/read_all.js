// Reads every message of the files on the command line with @mcap/core, and decodes each by the
// schema in the file. Prints the number of messages of each topic as JSON.
const fs = require("fs");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const fzstd = require("fzstd");
const protobuf = require("protobufjs");
const descriptor = require("protobufjs/ext/descriptor");

const decompressHandlers = {
  zstd: (bytes, size) => fzstd.decompress(bytes, new Uint8Array(Number(size))),
};

function typeOf(schema) {
  const files = descriptor.FileDescriptorSet.decode(schema.data);
  return protobuf.Root.fromDescriptor(files).lookupType(schema.name);
}

class Topics {
  constructor() {
    this.counts = {};
    this.types = new Map();
  }
  take(channel, schema, message) {
    if (!this.types.has(schema.id)) this.types.set(schema.id, typeOf(schema));
    this.types.get(schema.id).decode(message.data);
    this.counts[channel.topic] = (this.counts[channel.topic] || 0) + 1;
  }
}

class File {
  constructor(name) {
    this.bytes = fs.readFileSync(name);
  }
  async size() {
    return BigInt(this.bytes.length);
  }
  async read(offset, length) {
    return new Uint8Array(this.bytes.subarray(Number(offset), Number(offset + length)));
  }
}

async function readIndexed(name) {
  const reader = await McapIndexedReader.Initialize({ readable: new File(name), decompressHandlers });
  const topics = new Topics();
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    const channel = reader.channelsById.get(message.channelId);
    topics.take(channel, reader.schemasById.get(channel.schemaId), message);
  }
  let attachments = 0;
  for await (const _ of reader.readAttachments()) ++attachments;
  let metadata = 0;
  for await (const _ of reader.readMetadata()) ++metadata;
  const total = Number(reader.statistics.messageCount);
  return { topics: topics.counts, attachments, metadata, total };
}

function readStream(name) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(fs.readFileSync(name));
  const schemas = new Map();
  const channels = new Map();
  const topics = new Topics();
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type !== "Message") continue;
    const channel = channels.get(record.channelId);
    topics.take(channel, schemas.get(channel.schemaId), record);
  }
  return { topics: topics.counts };
}

async function main() {
  const results = [];
  for (const name of process.argv.slice(2)) {
    results.push({ indexed: await readIndexed(name), stream: readStream(name) });
  }
  console.log(JSON.stringify(results));
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
