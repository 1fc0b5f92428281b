#include <bit>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "can/bus/candump.h"
#include "can/e2e/e2e.h"
#include "can/messages/consumer_writer.h"
#include "can/messages/dbc_writer.h"
#include "can/messages/markdown_writer.h"
#include "can/messages/message_table.h"
#include "can/messages/pose_report.h"
#include "tests/can/messages/dbc_parser.h"
#include "tests/support/text.h"

namespace bevloc::can {
namespace {

const std::string kSource = BEVLOC_SOURCE_DIR;

std::vector<const Signal*> all_signals(const Message& message) {
  const auto header = e2e_header(message.format);
  std::vector<const Signal*> signals(header.begin(), header.end());
  signals.insert(signals.end(), message.signals.begin(), message.signals.end());
  return signals;
}

TEST(Dbc, CommittedFileMatchesTheMessageTable) {
  EXPECT_EQ(test::read_text(kSource + "/can/bevloc.dbc"), dbc_text())
      << "write it again: bevloc_dbc > can/bevloc.dbc";
}

TEST(Dbc, DocumentedTablesMatchTheMessageTable) {
  EXPECT_NE(test::read_text(kSource + "/docs/can.md").find(markdown_tables()), std::string::npos)
      << "replace them by the output of: bevloc_dbc --markdown";
}

TEST(Dbc, ConstantsOfConsumersHaveTheGivenBase) {
  const BaseIds base{.localizer = 0x620};
  EXPECT_NE(consumer_header_text(base).find("#define BEVLOC_LOCALIZER_BASE 0x620u\n"),
            std::string::npos);
  EXPECT_NE(consumer_python_text(base).find("\nLOCALIZER_BASE = 0x620\n"), std::string::npos);
}

TEST(Dbc, DocumentedExampleFrameIsRight) {
  Frame frame = blank_frame(loc_pos_local::kMessage, BaseIds{});
  E2eSender(loc_pos_local::kMessage.protection()).protect(frame);
  EXPECT_NE(test::read_text(kSource + "/docs/can.md").find("`504#D700000080000080`"),
            std::string::npos);
  EXPECT_TRUE(candump_line({}, "can0", frame).ends_with(" 504#D700000080000080"));
}

TEST(Dbc, NamesEveryMessageAndSignal) {
  const test::Dbc dbc = test::load_dbc(kSource + "/can/bevloc.dbc");
  EXPECT_EQ(dbc.messages.size(), std::size(kMessages));
  for (const Message* message : kMessages) {
    const test::DbcMessage& written = dbc.message(std::string(message->name));
    EXPECT_EQ(written.id, message->id(BaseIds{}));
    EXPECT_EQ(written.length, message->length);
    EXPECT_EQ(written.attributes.at("E2EDataId"), message->data_id);
    EXPECT_EQ(written.attributes.at("GenMsgCycleTime"), message->cycle_ms);
    const bool fd = message->format == FrameFormat::kFd;
    EXPECT_EQ(written.texts.contains("E2EProfile"), fd);
    EXPECT_EQ(written.attributes.contains("VFrameFormat"), fd);
    EXPECT_EQ(written.signals.size(), all_signals(*message).size());
    for (const Signal* signal : all_signals(*message)) {
      const test::DbcSignal& read = written.signal(std::string(signal->name));
      EXPECT_EQ(read.comment, signal->comment);
      EXPECT_EQ(read.unit, signal->unit);
      for (const ValueName& value : signal->value_names) {
        EXPECT_EQ(read.value_names.at(value.raw), value.name);
      }
    }
  }
}

TEST(Dbc, BaseIdsMoveTheMessages) {
  const test::Dbc dbc = test::parse_dbc(dbc_text({.localizer = 0x620, .vehicle = 0x100}));
  EXPECT_EQ(dbc.message("LOC_Latitude").id, 0x622u);
  EXPECT_EQ(dbc.message("VEH_YawRate").id, 0x101u);
}

/// A reader of the DBC file decodes the values that the message table encodes.
TEST(Dbc, ReaderDecodesTheEncodedValues) {
  const test::Dbc dbc = test::load_dbc(kSource + "/can/bevloc.dbc");
  for (const Message* message : kMessages) {
    for (const Signal* signal : all_signals(*message)) {
      SCOPED_TRACE(std::string(message->name) + "." + std::string(signal->name));
      const test::DbcSignal& read =
          dbc.message(std::string(message->name)).signal(std::string(signal->name));
      EXPECT_EQ(read.min, signal->min);
      EXPECT_EQ(read.max, signal->max);
      const int64_t middle = (signal->min_raw() + signal->max_raw()) / 2;
      for (const double physical : {signal->min, signal->physical(middle), signal->max}) {
        for (const uint8_t fill : {uint8_t{0x00}, uint8_t{0xFF}}) {
          Frame frame{.id = 0, .length = message->length};
          frame.data.fill(fill);
          insert_raw(frame, *signal, signal->nearest_raw(physical));
          EXPECT_NEAR(read.physical_from(frame.payload()), physical, 1e-3 * signal->scale);
          EXPECT_FALSE(read.is_sna(frame.payload()));
          EXPECT_EQ(extract_raw(frame, *signal), read.raw_from(frame.payload()));
        }
      }
      if (!signal->has_sna) continue;
      Frame frame{.id = 0, .length = message->length};
      encode(frame, *signal, PoseReport::kUnknown);
      EXPECT_TRUE(read.is_sna(frame.payload()));
      EXPECT_FALSE(decode(frame, *signal));
      encode(frame, *signal, 1e12);
      EXPECT_NEAR(read.physical_from(frame.payload()), signal->max, 1e-3 * signal->scale);
      encode(frame, *signal, -1e12);
      EXPECT_NEAR(read.physical_from(frame.payload()), signal->min, 1e-3 * signal->scale);
    }
  }
}

TEST(MessageTable, EnumerationsMatchTheValueNames) {
  const auto name_of = [](const Signal& signal, auto value) {
    return signal.value_names[static_cast<size_t>(value)].name;
  };
  EXPECT_EQ(name_of(loc_status::kState, HealthState::kInit), "INIT");
  EXPECT_EQ(name_of(loc_status::kState, HealthState::kAcquiring), "ACQUIRING");
  EXPECT_EQ(name_of(loc_status::kState, HealthState::kTracking), "TRACKING");
  EXPECT_EQ(name_of(loc_status::kState, HealthState::kDegraded), "DEGRADED");
  EXPECT_EQ(name_of(loc_status::kState, HealthState::kLost), "LOST");
  EXPECT_EQ(name_of(loc_status::kState, HealthState::kFault), "FAULT");
  EXPECT_EQ(name_of(loc_status::kTimeSource, TimeSource::kFreeRunning), "FREE_RUNNING");
  EXPECT_EQ(name_of(loc_status::kTimeSource, TimeSource::kPtp), "PTP");
  EXPECT_EQ(name_of(loc_status::kTimeSource, TimeSource::kGnss), "GNSS");
  EXPECT_EQ(name_of(loc_status::kTimeSource, TimeSource::kNtp), "NTP");

  const auto why_name = [](Why why) {
    const auto bit = static_cast<size_t>(std::countr_zero(WhyMask(why).bits()));
    const size_t in_status = loc_status::kWhy.size();
    return bit < in_status ? loc_status::kWhy[bit].name : loc_integrity::kWhy[bit - in_status].name;
  };
  EXPECT_EQ(why_name(Why::kCameraMissing), "Why_CameraMissing");
  EXPECT_EQ(why_name(Why::kCamerasUnsynchronized), "Why_CamerasUnsynchronized");
  EXPECT_EQ(why_name(Why::kOdometryMissing), "Why_OdometryMissing");
  EXPECT_EQ(why_name(Why::kGnssMissing), "Why_GnssMissing");
  EXPECT_EQ(why_name(Why::kNoInitialPose), "Why_NoInitialPose");
  EXPECT_EQ(why_name(Why::kOutsideMap), "Why_OutsideMap");
  EXPECT_EQ(why_name(Why::kMatchUncertain), "Why_MatchUncertain");
  EXPECT_EQ(why_name(Why::kMatchRejected), "Why_MatchRejected");
  EXPECT_EQ(why_name(Why::kPoseUncertain), "Why_PoseUncertain");
  EXPECT_EQ(why_name(Why::kPoseStale), "Why_PoseStale");
  EXPECT_EQ(why_name(Why::kPoseInvalid), "Why_PoseInvalid");
  EXPECT_EQ(why_name(Why::kOverload), "Why_Overload");
  EXPECT_EQ(why_name(Why::kMapFault), "Why_MapFault");
  EXPECT_EQ(why_name(Why::kCalibrationFault), "Why_CalibrationFault");
  EXPECT_EQ(why_name(Why::kNetworkFault), "Why_NetworkFault");
  EXPECT_EQ(why_name(Why::kInternalFault), "Why_InternalFault");
  EXPECT_EQ(why_name(Why::kGnssContradicts), "Why_GnssContradicts");
  EXPECT_EQ(why_name(Why::kOdometryContradicts), "Why_OdometryContradicts");
  EXPECT_EQ(why_name(Why::kMatchContradicts), "Why_MatchContradicts");
  EXPECT_EQ(why_name(Why::kClockGap), "Why_ClockGap");
  EXPECT_EQ(why_name(Why::kOdometryImplausible), "Why_OdometryImplausible");
  EXPECT_EQ(why_name(Why::kForeignSender), "Why_ForeignSender");
}

TEST(MessageTable, BlankFramesAreNotAvailable) {
  for (const Message* message : kMessages) {
    const Frame frame = blank_frame(*message, BaseIds{});
    for (const Signal* signal : message->signals) {
      if (signal->has_sna) {
        EXPECT_FALSE(decode(frame, *signal)) << signal->name;
      } else {
        EXPECT_EQ(extract_raw(frame, *signal), 0) << signal->name;
      }
    }
  }
}

}  // namespace
}  // namespace bevloc::can
