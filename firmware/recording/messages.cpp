#include "firmware/recording/messages.h"

#include <algorithm>
#include <cmath>

#include "common/cameras.h"

namespace bevloc::firmware {
namespace {

constexpr int64_t kSecond_ns = 1'000'000'000;

uint64_t clock_ns(Time time) {
  return static_cast<uint64_t>(time.time_since_epoch().count());
}

/// Returns the name that common viewers of MCAP files use, if they have one for the format.
std::string_view encoding_of(PixelFormat format) {
  switch (format) {
    case PixelFormat::kRgb24:
      return "rgb8";
    case PixelFormat::kYuyv:
      return "yuv422_yuy2";
    case PixelFormat::kUyvy:
      return "yuv422";
    case PixelFormat::kBayerRggb:
      return "bayer_rggb8";
    case PixelFormat::kBayerGrbg:
      return "bayer_grbg8";
    case PixelFormat::kBayerGbrg:
      return "bayer_gbrg8";
    case PixelFormat::kBayerBggr:
      return "bayer_bggr8";
    default:
      return to_string(format);
  }
}

void set_time(uint64_t time_ns, google::protobuf::Timestamp& timestamp) {
  timestamp.set_seconds(static_cast<int64_t>(time_ns) / kSecond_ns);
  timestamp.set_nanos(static_cast<int32_t>(static_cast<int64_t>(time_ns) % kSecond_ns));
}

void set_pose(const Se2& pose, recording::Pose2& message) {
  message.set_x_m(pose.x_m);
  message.set_y_m(pose.y_m);
  message.set_yaw_rad(pose.yaw_rad);
}

template <typename Matrix, typename Message>
void add_covariance(const Matrix& covariance, Message& message) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) message.add_covariance(covariance(row, column));
  }
}

}  // namespace

foxglove::RawImage raw_image(const RecordedImage& image, uint64_t exposure_start_ns) {
  foxglove::RawImage message;
  set_time(exposure_start_ns, *message.mutable_timestamp());
  message.set_frame_id(std::string(kCameraNames[image.camera]));
  message.set_width(static_cast<uint32_t>(image.image.width));
  message.set_height(static_cast<uint32_t>(image.image.height));
  message.set_encoding(std::string(encoding_of(image.image.format)));
  message.set_step(static_cast<uint32_t>(image.image.planes[0].stride_bytes));
  message.set_data(image.image.planes[0].data, image.image.bytes_used);
  message.set_exposure_ns(image.exposure.count());
  message.set_sequence(image.sequence);
  message.set_bt709(image.image.yuv.matrix == YuvMatrix::kBt709);
  message.set_full_range(image.image.yuv.full_range);
  return message;
}

foxglove::CompressedImage compressed_image(const RecordedImage& image, std::string_view jpeg,
                                           uint64_t exposure_start_ns) {
  foxglove::CompressedImage message;
  set_time(exposure_start_ns, *message.mutable_timestamp());
  message.set_frame_id(std::string(kCameraNames[image.camera]));
  message.set_data(jpeg.data(), jpeg.size());
  message.set_format("jpeg");
  message.set_exposure_ns(image.exposure.count());
  message.set_sequence(image.sequence);
  message.set_from_camera(image.image.format == PixelFormat::kMjpeg);
  return message;
}

foxglove::PoseInFrame pose_message(const Se2& map_from_vehicle, uint64_t time_ns) {
  foxglove::PoseInFrame message;
  set_time(time_ns, *message.mutable_timestamp());
  message.set_frame_id("map");
  foxglove::Vector3& position = *message.mutable_pose()->mutable_position();
  position.set_x(map_from_vehicle.x_m);
  position.set_y(map_from_vehicle.y_m);
  foxglove::Quaternion& rotation = *message.mutable_pose()->mutable_orientation();
  rotation.set_z(std::sin(0.5 * map_from_vehicle.yaw_rad));
  rotation.set_w(std::cos(0.5 * map_from_vehicle.yaw_rad));
  return message;
}

Se2 pose_of(const foxglove::PoseInFrame& message) {
  const foxglove::Pose& pose = message.pose();
  return {pose.position().x(), pose.position().y(),
          wrap_angle(2.0 * std::atan2(pose.orientation().z(), pose.orientation().w()))};
}

foxglove::CameraCalibration calibration_message(const CameraModel& camera, int index) {
  const Intrinsics& lens = camera.intrinsics;
  foxglove::CameraCalibration message;
  message.set_frame_id(std::string(kCameraNames[index]));
  message.set_width(static_cast<uint32_t>(lens.width_px));
  message.set_height(static_cast<uint32_t>(lens.height_px));
  const bool fisheye = lens.lens == Lens::kFisheye;
  message.set_distortion_model(fisheye ? "kannala_brandt" : "plumb_bob");
  for (const double k : {lens.k1, lens.k2}) message.add_d(k);
  for (const double k : fisheye ? std::array{lens.k3, lens.k4} : std::array{lens.p1, lens.p2}) {
    message.add_d(k);
  }
  if (!fisheye) message.add_d(0.0);
  for (const double k : {lens.fx_px, 0.0, lens.cx_px, 0.0, lens.fy_px, lens.cy_px, 0.0, 0.0, 1.0}) {
    message.add_k(k);
  }
  for (const double r : {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) message.add_r(r);
  for (const double p :
       {lens.fx_px, 0.0, lens.cx_px, 0.0, 0.0, lens.fy_px, lens.cy_px, 0.0, 0.0, 0.0, 1.0, 0.0}) {
    message.add_p(p);
  }
  return message;
}

recording::CanFrame bus_message(const RecordedBusFrame& frame) {
  recording::CanFrame message;
  message.set_id(frame.frame.id);
  message.set_data(frame.frame.data.data(), frame.frame.length);
  message.set_fd(frame.frame.format == can::FrameFormat::kFd);
  message.set_clock_ns(clock_ns(frame.stamp));
  return message;
}

Result<can::ReceivedFrame> bus_frame_of(const recording::CanFrame& message) {
  can::ReceivedFrame received;
  received.frame.format = message.fd() ? can::FrameFormat::kFd : can::FrameFormat::kClassic;
  if (message.id() > can::kMaxStandardId ||
      !can::is_valid_length(received.frame.format, message.data().size())) {
    return fail("found a frame with identifier {:#x} and {} bytes, wanted a CAN frame",
                message.id(), message.data().size());
  }
  received.frame.id = message.id();
  received.frame.length = static_cast<uint8_t>(message.data().size());
  std::ranges::copy(message.data(), received.frame.data.begin());
  received.received = Time(Duration(static_cast<int64_t>(message.clock_ns())));
  return received;
}

foxglove::LocationFix fix_message(const RecordedFix& recorded, uint64_t held_ns) {
  constexpr uint32_t kApproximated = 1;
  const drivers::GnssFix& fix = recorded.fix;
  foxglove::LocationFix message;
  set_time(held_ns, *message.mutable_timestamp());
  message.set_frame_id("gnss");
  message.set_latitude(fix.latitude_deg);
  message.set_longitude(fix.longitude_deg);
  const double east_m2 = fix.sigma_east_m * fix.sigma_east_m;
  const double north_m2 = fix.sigma_north_m * fix.sigma_north_m;
  for (const double m2 : {east_m2, 0.0, 0.0, 0.0, north_m2, 0.0, 0.0, 0.0, 0.0}) {
    message.add_position_covariance(m2);
  }
  message.set_position_covariance_type(kApproximated);
  message.set_clock_ns(clock_ns(recorded.held.time));
  message.set_clock_sigma_ns(recorded.held.sigma.count());
  message.set_utc_ns(fix.utc.count());
  if (fix.speed_mps) message.set_speed_mps(*fix.speed_mps);
  if (fix.course_deg) message.set_course_deg(*fix.course_deg);
  message.set_sigma_course_deg(fix.sigma_course_deg);
  return message;
}

Result<RecordedFix> fix_of(const foxglove::LocationFix& message, Time time) {
  constexpr int kCovariances = 9;
  RecordedFix recorded;
  recorded.time = time;
  drivers::GnssFix& fix = recorded.fix;
  fix.latitude_deg = message.latitude();
  fix.longitude_deg = message.longitude();
  if (message.position_covariance_size() == kCovariances) {
    fix.sigma_east_m = std::sqrt(message.position_covariance(0));
    fix.sigma_north_m = std::sqrt(message.position_covariance(4));
  }
  if (message.has_speed_mps()) fix.speed_mps = message.speed_mps();
  if (message.has_course_deg()) fix.course_deg = message.course_deg();
  fix.sigma_course_deg = message.sigma_course_deg();
  fix.utc = std::chrono::nanoseconds(message.utc_ns());
  recorded.held = {drivers::FixVerdict::kUsable,
                   Time(Duration(static_cast<int64_t>(message.clock_ns()))),
                   Duration(message.clock_sigma_ns())};
  const bool is_good = message.position_covariance_size() == kCovariances &&
                       drivers::is_possible(fix) && message.clock_sigma_ns() >= 0;
  if (is_good) return recorded;
  return fail("found a position {:g}, {:g} with values that no receiver reports, wanted a fix",
              message.latitude(), message.longitude());
}

recording::Solution solution_message(const can::PoseReport& report) {
  recording::Solution message;
  message.set_state(static_cast<uint32_t>(report.status.state));
  message.set_why(report.status.why.bits());
  message.set_cameras(report.status.camera_ok_mask);
  message.set_pose_known(report.map_from_vehicle.is_finite());
  if (report.capture_time) message.set_capture_clock_ns(clock_ns(*report.capture_time));
  if (!message.pose_known()) return message;
  set_pose(report.map_from_vehicle, *message.mutable_map_from_vehicle());
  add_covariance(report.covariance, message);
  message.set_protection_longitudinal_m(report.protection_level.longitudinal_m);
  message.set_protection_lateral_m(report.protection_level.lateral_m);
  message.set_protection_yaw_rad(report.protection_level.yaw_rad);
  message.set_speed_mps(report.forward_speed_mps);
  return message;
}

recording::Match match_message(const RecordedMatch& match) {
  recording::Match message;
  message.set_frameset_clock_ns(clock_ns(match.frame_time));
  message.set_cameras(match.cameras);
  set_pose(match.prior, *message.mutable_prior());
  set_pose(match.match.correction, *message.mutable_correction());
  add_covariance(match.match.covariance, message);
  message.set_evidence(match.match.evidence == Evidence::kGood);
  message.set_score(match.match.score);
  message.set_acquiring(match.acquiring);
  message.set_x_range_m(match.ranges[0]);
  message.set_y_range_m(match.ranges[1]);
  message.set_yaw_range_rad(match.ranges[2]);
  const auto fill = [](const RecordedDistribution& from, auto* to) {
    to->Add(from.probability.begin(), from.probability.begin() + from.count);
  };
  fill(match.distributions[0], message.mutable_x_probability());
  fill(match.distributions[1], message.mutable_y_probability());
  fill(match.distributions[2], message.mutable_yaw_probability());
  return message;
}

recording::Map map_message(const HdMap& map) {
  recording::Map message;
  message.set_name(map.name);
  message.set_origin_latitude_deg(map.origin.latitude_deg);
  message.set_origin_longitude_deg(map.origin.longitude_deg);
  size_t points = 0;
  for (const MapElement& element : map.elements) points += element.points.size();
  message.set_left_out(points > kMostMapPoints);
  if (message.left_out()) return message;
  for (const MapElement& element : map.elements) {
    recording::MapElement& added = *message.add_elements();
    added.set_element_class(static_cast<uint32_t>(element.element_class));
    added.set_appearance(static_cast<uint32_t>(element.appearance));
    for (const Eigen::Vector2d& point : element.points) {
      added.add_points_m(point.x());
      added.add_points_m(point.y());
    }
  }
  return message;
}

std::optional<HdMap> map_of(const recording::Map& message) {
  if (message.left_out()) return std::nullopt;
  HdMap map;
  map.name = message.name();
  map.origin = {message.origin_latitude_deg(), message.origin_longitude_deg()};
  for (const recording::MapElement& element : message.elements()) {
    if (element.element_class() >= kElementClasses) continue;
    MapElement& added = map.elements.emplace_back();
    added.element_class = static_cast<ElementClass>(element.element_class());
    added.appearance = static_cast<Appearance>(element.appearance());
    for (int i = 0; i + 1 < element.points_m_size(); i += 2) {
      added.points.emplace_back(element.points_m(i), element.points_m(i + 1));
    }
  }
  return map;
}

Se2 se2_of(const recording::Pose2& pose) {
  return {pose.x_m(), pose.y_m(), pose.yaw_rad()};
}

}  // namespace bevloc::firmware
