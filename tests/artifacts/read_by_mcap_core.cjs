// Reads a recording by npm's @mcap/core, by its index and as a stream, and prints what it found as JSON.
const fs = require("fs");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { loadDecompressHandlers } = require("@mcap/support");

async function indexed(path, decompressHandlers) {
  const handle = await fs.promises.open(path, "r");
  const readable = {
    size: async () => BigInt((await handle.stat()).size),
    read: async (offset, length) => {
      const data = new Uint8Array(Number(length));
      await handle.read(data, 0, Number(length), Number(offset));
      return data;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const found = { topics: {}, schemas: {}, metadata: {}, attachments: {} };
  for (const channel of reader.channelsById.values()) {
    const schema = reader.schemasById.get(channel.schemaId);
    found.topics[channel.topic] = 0;
    found.schemas[channel.topic] = [schema.encoding, schema.name, channel.messageEncoding];
  }
  for await (const message of reader.readMessages()) {
    found.topics[reader.channelsById.get(message.channelId).topic] += 1;
  }
  for await (const record of reader.readMetadata()) {
    found.metadata[record.name] = Object.fromEntries(record.metadata);
  }
  for await (const record of reader.readAttachments()) {
    found.attachments[record.name] = Buffer.from(record.data).toString();
  }
  await handle.close();
  return found;
}

function streamed(path, decompressHandlers) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(fs.readFileSync(path));
  let messages = 0;
  for (let record; (record = reader.nextRecord()); ) {
    messages += record.type === "Message";
  }
  return { messages, done: reader.done() };
}

loadDecompressHandlers().then(async (handlers) => {
  const path = process.argv[2];
  console.log(JSON.stringify({ ...(await indexed(path, handlers)), streamed: streamed(path, handlers) }));
});
