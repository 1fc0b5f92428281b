#include "evaluation/recording/played_devices.h"

#include <algorithm>
#include <array>

#include "common/cameras.h"
#include "common/jpeg.h"
#include "common/rgb_conversion.h"
#include "firmware/recording/topics.h"

namespace bevloc::evaluation {
namespace {

constexpr const char* kRawSchema = "foxglove.RawImage";

struct EncodingName {
  std::string_view name;
  PixelFormat format;
};
constexpr std::array<EncodingName, 8> kEncodings{{{"rgb8", PixelFormat::kRgb24},
                                                  {"yuv422_yuy2", PixelFormat::kYuyv},
                                                  {"yuv422", PixelFormat::kUyvy},
                                                  {"nv12", PixelFormat::kNv12},
                                                  {"bayer_rggb8", PixelFormat::kBayerRggb},
                                                  {"bayer_grbg8", PixelFormat::kBayerGrbg},
                                                  {"bayer_gbrg8", PixelFormat::kBayerGbrg},
                                                  {"bayer_bggr8", PixelFormat::kBayerBggr}}};

/// Owns the bytes of one image as long as a frame refers to them.
class ImageBytes final : public drivers::FrameLender {
 public:
  explicit ImageBytes(std::string bytes) : bytes_(std::move(bytes)) {}
  const uint8_t* data() const { return reinterpret_cast<const uint8_t*>(bytes_.data()); }
  size_t size() const { return bytes_.size(); }

 private:
  void give_back(int /*slot*/) noexcept override {}
  std::string bytes_;
};

size_t least_row_bytes(PixelFormat format, size_t width) {
  if (format == PixelFormat::kRgb24) return 3 * width;
  const bool pairs = format == PixelFormat::kYuyv || format == PixelFormat::kUyvy;
  return pairs ? 2 * ((width + 1) & ~size_t{1}) : width;
}

drivers::FrameBuffer buffer_of(std::string bytes, ImageView view, size_t row, size_t rows) {
  auto memory = std::make_shared<ImageBytes>(std::move(bytes));
  view.bytes_used = memory->size();
  view.planes[0] = {memory->data(), static_cast<std::ptrdiff_t>(row)};
  if (view.format == PixelFormat::kNv12) {
    view.planes[1] = {memory->data() + row * rows,
                      static_cast<std::ptrdiff_t>((row + 1) & ~size_t{1})};
  }
  return {std::move(memory), 0, view};
}

Result<drivers::FrameBuffer> raw_buffer(foxglove::RawImage& message, int camera) {
  const auto known = std::ranges::find(kEncodings, message.encoding(), &EncodingName::name);
  ImageView view;
  view.width = static_cast<int>(message.width());
  view.height = static_cast<int>(message.height());
  const size_t row = message.step();
  const size_t rows = message.height();
  constexpr uint32_t kMostPixels = 1U << 15U;
  const bool sane = known != kEncodings.end() && message.width() >= 1 && rows >= 1 &&
                    message.width() < kMostPixels && rows < kMostPixels &&
                    row >= least_row_bytes(known->format, message.width()) && row < 4 * kMostPixels;
  const bool nv12 = sane && known->format == PixelFormat::kNv12;
  const size_t chroma = nv12 ? ((row + 1) & ~size_t{1}) * ((rows + 1) / 2) : 0;
  if (!sane || message.data().size() < row * rows + chroma) {
    return fail("camera {}: found a recorded image of {}x{} {} in {} bytes, wanted a whole one",
                kCameraNames[camera], message.width(), rows, message.encoding(),
                message.data().size());
  }
  view.format = known->format;
  view.yuv = {message.bt709() ? YuvMatrix::kBt709 : YuvMatrix::kBt601, message.full_range()};
  return buffer_of(std::move(*message.mutable_data()), view, row, rows);
}

Result<drivers::FrameBuffer> jpeg_buffer(foxglove::CompressedImage& message, int camera,
                                         int width_px, int height_px) {
  ImageView view;
  view.width = width_px;
  view.height = height_px;
  if (message.from_camera()) {
    view.format = PixelFormat::kMjpeg;
    return buffer_of(std::move(*message.mutable_data()), view, 0, 0);
  }
  const auto image = decode_jpeg(message.data(), fmt::format("camera {}", kCameraNames[camera]));
  if (!image) return tl::unexpected(image.error());
  view.width = image->width;
  view.height = image->height;
  std::string pixels(image->pixels.begin(), image->pixels.end());
  const auto row = 3 * static_cast<size_t>(image->width);
  return buffer_of(std::move(pixels), view, row, static_cast<size_t>(image->height));
}

/// What both kinds of images say about their frame.
template <typename Message>
drivers::Frame frame_of(const Message& message, int camera, Time time,
                        drivers::FrameBuffer buffer) {
  return {camera, time, message.sequence(), Duration(message.exposure_ns()), std::move(buffer)};
}

template <typename Message>
Time exposure_start(const Recording& recording, const Message& message) {
  constexpr uint64_t kSecond_ns = 1'000'000'000;
  return recording.clock_time(static_cast<uint64_t>(message.timestamp().seconds()) * kSecond_ns +
                              static_cast<uint64_t>(message.timestamp().nanos()));
}

Result<drivers::Frame> read_frame(Recording& recording, const MessagePlace& place, bool raw,
                                  int camera, int width_px, int height_px) {
  if (raw) {
    auto message = recording.read<foxglove::RawImage>(place);
    if (!message) return tl::unexpected(message.error());
    auto buffer = raw_buffer(*message, camera);
    if (!buffer) return tl::unexpected(buffer.error());
    return frame_of(*message, camera, exposure_start(recording, *message), std::move(*buffer));
  }
  auto message = recording.read<foxglove::CompressedImage>(place);
  if (!message) return tl::unexpected(message.error());
  auto buffer = jpeg_buffer(*message, camera, width_px, height_px);
  if (!buffer) return tl::unexpected(buffer.error());
  return frame_of(*message, camera, exposure_start(recording, *message), std::move(*buffer));
}

}  // namespace

PlayedCamera::PlayedCamera(Recording& recording, int camera, int width_px, int height_px,
                           const drivers::Clock& clock)
    : recording_(recording),
      clock_(clock),
      camera_(camera),
      width_px_(width_px),
      height_px_(height_px),
      places_(recording.messages(firmware::image_topic(camera))),
      raw_(recording.has_schema(firmware::image_topic(camera), kRawSchema)) {}

Status PlayedCamera::start() {
  if (running_) return fail("camera {}: already started", kCameraNames[camera_]);
  running_ = true;
  return {};
}

Result<drivers::FrameEvent> PlayedCamera::next_frame(Duration /*timeout*/, drivers::Frame& frame) {
  if (!running_) return fail("camera {}: not started", kCameraNames[camera_]);
  if (next_ == places_.size()) return drivers::FrameEvent::kEnded;
  const MessagePlace& place = places_[next_];
  if (recording_.clock_time(place.log_time_ns) > clock_.now()) return drivers::FrameEvent::kTimeout;
  ++next_;
  auto read = read_frame(recording_, place, raw_, camera_, width_px_, height_px_);
  if (!read) return tl::unexpected(read.error());
  frame = std::move(*read);
  ++counters_.delivered;
  return drivers::FrameEvent::kFrame;
}

drivers::CameraDescription PlayedCamera::description() const {
  return {camera_, width_px_, height_px_, drivers::kDefaultFrameBuffers};
}

can::SendResult PlayedBus::send(const can::Frame& frame, Time now) {
  ++counters_.sent;
  seen_(frame, now, true);
  return can::SendResult::kSent;
}

std::optional<can::ReceivedFrame> PlayedBus::receive() {
  if (!wait(Duration::zero())) return std::nullopt;
  ++counters_.received;
  const can::ReceivedFrame& received = frames_[next_++].frame;
  seen_(received.frame, received.received, false);
  return received;
}

bool PlayedBus::wait(Duration /*timeout*/) {
  return next_ < frames_.size() && frames_[next_].delivered <= clock_.now();
}

Result<std::vector<PlayedFrame>> played_frames(Recording& recording, std::string_view topic) {
  std::vector<PlayedFrame> frames;
  for (const MessagePlace& place : recording.messages(topic)) {
    const auto message = recording.read<bevloc::recording::CanFrame>(place);
    if (!message) return tl::unexpected(message.error());
    const auto frame = firmware::bus_frame_of(*message);
    if (!frame) return fail("{}: {}", topic, frame.error().message);
    frames.push_back({recording.clock_time(place.log_time_ns), *frame});
  }
  return frames;
}

Result<drivers::Frame> read_recorded_frame(Recording& recording, int camera, size_t number,
                                           const Intrinsics& lens) {
  const std::string topic = firmware::image_topic(camera);
  return read_frame(recording, recording.messages(topic)[number],
                    recording.has_schema(topic, kRawSchema), camera, lens.width_px, lens.height_px);
}

Result<RgbImage> picture_at(Recording& recording, int camera, const MessagePlace& place) {
  const bool raw = recording.has_schema(firmware::image_topic(camera), kRawSchema);
  const auto frame = read_frame(recording, place, raw, camera, 0, 0);
  if (!frame) return tl::unexpected(frame.error());
  const ImageView& view = frame->image();
  if (view.format == PixelFormat::kMjpeg) {
    const std::string_view jpeg(reinterpret_cast<const char*>(view.planes[0].data),
                                view.bytes_used);
    return decode_jpeg(jpeg, fmt::format("camera {}", kCameraNames[camera]));
  }
  RgbImage image(view.width, view.height);
  convert_to_rgb(view, image);
  return image;
}

}  // namespace bevloc::evaluation
