#include "tests/hil/usb_cameras/uvc_descriptors.h"

namespace bevloc::hil {
namespace {

constexpr uint8_t kInterface = 0x04;
constexpr uint8_t kEndpoint = 0x05;
constexpr uint8_t kAssociation = 0x0B;
constexpr uint8_t kClassSpecific = 0x24;
constexpr uint8_t kVideoClass = 0x0E;
constexpr uint8_t kBulk = 2;
// Subtypes of class-specific descriptors (UVC 1.0, A.5 and A.6).
constexpr uint8_t kVcHeader = 1, kInputTerminal = 2, kOutputTerminal = 3;
constexpr uint8_t kVsInputHeader = 1, kFormatUncompressed = 4, kFrameUncompressed = 5;
constexpr uint8_t kFormatMjpeg = 6, kFrameMjpeg = 7, kColorMatching = 13;
constexpr uint8_t kCameraTerminalId = 1, kStreamTerminalId = 2;

/// Appends a descriptor, preceded by its length.
void append(Bytes& bytes, Bytes descriptor) {
  descriptor.insert(descriptor.begin(), static_cast<uint8_t>(descriptor.size() + 1));
  bytes.insert(bytes.end(), descriptor.begin(), descriptor.end());
}

Bytes video_control() {
  Bytes header{kClassSpecific, kVcHeader};
  append_u16(header, 0x0100);  // UVC 1.0
  append_u16(header, 13 + 18 + 9);
  append_u32(header, 48'000'000);  // timestamp clock in Hz, not used
  header.insert(header.end(), {1, kStreamInterface});

  Bytes camera{kClassSpecific, kInputTerminal, kCameraTerminalId};
  append_u16(camera, 0x0201);                                         // a camera sensor
  camera.insert(camera.end(), {0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0});  // no zoom, no controls
  Bytes stream{kClassSpecific, kOutputTerminal, kStreamTerminalId};
  append_u16(stream, 0x0101);  // USB streaming
  stream.insert(stream.end(), {0, kCameraTerminalId, 0});

  Bytes bytes;
  append(bytes, {kInterface, kControlInterface, 0, 0, kVideoClass, 1, 0, 0});
  append(bytes, header);
  append(bytes, camera);
  append(bytes, stream);
  return bytes;
}

Bytes frame(uint8_t subtype) {
  Bytes bytes{kClassSpecific, subtype, 1, 0};
  append_u16(bytes, kWidthPx);
  append_u16(bytes, kHeightPx);
  append_u32(bytes, 8 * kYuyvBytes * kFrameRates.front());
  append_u32(bytes, 8 * kYuyvBytes * kFrameRates.back());
  append_u32(bytes, kYuyvBytes);
  append_u32(bytes, frame_interval(kFrameRates.back()));
  bytes.push_back(kFrameRates.size());
  for (auto rate = kFrameRates.rbegin(); rate != kFrameRates.rend(); ++rate) {
    append_u32(bytes, frame_interval(*rate));  // the shortest interval first
  }
  return bytes;
}

/// BT.709 primaries and transfer, BT.601 matrix.
Bytes color_matching() {
  return {kClassSpecific, kColorMatching, 1, 1, 4};
}

Bytes formats() {
  Bytes yuyv{kClassSpecific, kFormatUncompressed, static_cast<uint8_t>(PixelFormat::kYuyv), 1};
  yuyv.insert(yuyv.end(), {'Y',  'U', 'Y',  '2',  0,    0,  0x10, 0, 0x80, 0, 0,
                           0xAA, 0,   0x38, 0x9B, 0x71, 16, 1,    0, 0,    0, 0});
  Bytes bytes;
  append(bytes, yuyv);
  append(bytes, frame(kFrameUncompressed));
  append(bytes, color_matching());
  append(bytes, {kClassSpecific, kFormatMjpeg, static_cast<uint8_t>(PixelFormat::kMjpeg), 1, 0, 1,
                 0, 0, 0, 0});
  append(bytes, frame(kFrameMjpeg));
  append(bytes, color_matching());
  return bytes;
}

Bytes video_streaming() {
  const Bytes described = formats();
  constexpr uint8_t kDescriptorHeaderBytes = 15;
  Bytes header{kClassSpecific, kVsInputHeader, 2};
  append_u16(header, kDescriptorHeaderBytes + static_cast<uint32_t>(described.size()));
  header.insert(header.end(), {kStreamEndpoint, 0, kStreamTerminalId, 0, 0, 0, 1, 0, 0});

  Bytes endpoint{kEndpoint, kStreamEndpoint, kBulk};
  append_u16(endpoint, kMaxPacketBytes);
  endpoint.push_back(0);

  Bytes bytes;
  append(bytes, {kInterface, kStreamInterface, 0, 1, kVideoClass, 2, 0, 0});
  append(bytes, header);
  bytes.insert(bytes.end(), described.begin(), described.end());
  append(bytes, endpoint);
  return bytes;
}

}  // namespace

void append_u16(Bytes& bytes, uint32_t value) {
  for (int shift = 0; shift < 16; shift += 8) bytes.push_back((value >> shift) & 0xFF);
}

void append_u32(Bytes& bytes, uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back((value >> shift) & 0xFF);
}

Bytes device_descriptor() {
  Bytes body{1};
  append_u16(body, 0x0200);
  body.insert(body.end(), {0xEF, 2, 1, 64});  // class by interface association
  append_u16(body, kVendorId);
  append_u16(body, kProductId);
  append_u16(body, 0x0100);
  body.insert(body.end(), {1, 2, 3, 1});
  Bytes bytes;
  append(bytes, body);
  return bytes;
}

Bytes device_qualifier() {
  Bytes bytes;
  append(bytes, {6, 0, 2, 0xEF, 2, 1, 64, 1, 0});
  return bytes;
}

Bytes configuration_descriptor() {
  Bytes body;
  append(body, {kAssociation, 0, 2, kVideoClass, 3, 0, 0});
  for (const Bytes& part : {video_control(), video_streaming()}) {
    body.insert(body.end(), part.begin(), part.end());
  }
  Bytes bytes{9, 2};
  append_u16(bytes, 9 + static_cast<uint32_t>(body.size()));
  bytes.insert(bytes.end(), {2, 1, 0, 0x80, 250});
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

Bytes string_descriptor(int index, const std::string& name) {
  Bytes body{3};
  switch (index) {
    case 0:
      append_u16(body, 0x0409);
      break;
    case 1:
    case 2:
    case 3: {
      const std::string texts[] = {"bevloc", "lab camera " + name, name};
      for (const char c : texts[index - 1]) append_u16(body, static_cast<uint8_t>(c));
      break;
    }
    default:
      return {};
  }
  Bytes bytes;
  append(bytes, body);
  return bytes;
}

}  // namespace bevloc::hil
