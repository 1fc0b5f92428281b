/* Reads bevloc's pose from the CAN bus and says whether a function may use it. C99, one header, no
   allocation, no global state. docs/vehicle-bus.md shows its use; docs/can.md is the reference.

   This header checks every frame (AUTOSAR E2E profile P02, or P05 for CAN FD), puts the frames of
   one EPOCH together, watches the time, and compares the protection levels with your alert limits:

     struct bevloc_receiver receiver;
     bevloc_init(&receiver, BEVLOC_LOCALIZER_BASE, alert_limits);
     // for every frame, with the time of its arrival on your own clock:
     bevloc_receive(&receiver, id, data, length, now_us);
     // whenever the function needs the pose:
     if (bevloc_answer(&receiver, now_us) == BEVLOC_USABLE) use(receiver.pose);

   One thread (not thread-safe). Different receivers are independent. */
#ifndef BEVLOC_H
#define BEVLOC_H

#include <float.h>
#include <stddef.h>
#include <string.h>

#include "bevloc_messages.h"

#if DBL_MANT_DIG < 53
#error "bevloc.h needs a double of 64 bits, because positions have more digits than a float"
#endif

/* Why the latest pose may or may not be used, in the order of the checks. */
enum bevloc_answer {
  BEVLOC_USABLE,
  BEVLOC_NO_POSE,        /* no complete pose or no LOC_Status yet */
  BEVLOC_TIMEOUT,        /* no pose for three cycles, or only one pose since such a pause, or no
                            LOC_Status for three of its cycles, or your clock was set back: `now_us`
                            is more than a cycle before the arrival of the pose or LOC_Status */
  BEVLOC_NOT_VALID,      /* the state is neither TRACKING nor DEGRADED */
  BEVLOC_FOREIGN_SENDER, /* a foreign sender is on the bus (Why_ForeignSender) */
  BEVLOC_NOT_AVAILABLE,  /* a value, the integrity risk, or the protection level of an axis with
                            an alert limit is not available */
  BEVLOC_BEYOND_LIMIT    /* a protection level is beyond its alert limit, or the risk is too high */
};

/* The largest errors with which the function is safe; 0 where it does not need the axis. */
struct bevloc_alert_limits {
  double lateral_m;
  double longitudinal_m;
  double yaw_deg;
  int risk_exponent; /* n: a risk of at most 10^-n for each pose */
};

/* The frames of the messages that make one pose, in the order of sending. */
enum { BEVLOC_PARTS = 8 };

struct bevloc_pose {
  uint64_t received_us; /* when its last frame arrived; the pose holds at the moment of sending */
  double age_ms;        /* age of the newest images that the pose comes from */
  bool has_capture;     /* whether the pose comes from images */
  uint32_t capture_us;  /* when they were taken, on the localizer's clock, modulo 2^32 */
  double latitude_deg, longitude_deg;
  double east_m, north_m; /* in the map, along east and north at its origin */
  double heading_deg;     /* clockwise from true north; for that of the map see Axes in can.md */
  double speed_mps;
  double lateral_m, longitudinal_m, yaw_deg;   /* protection levels */
  bool has_lateral, has_longitudinal, has_yaw; /* false: no protection level of this axis */
  int risk_exponent;
  bool foreign_sender; /* Why_ForeignSender */
  bool complete;       /* no other value is missing */
};

struct bevloc_counters {
  uint32_t ok, lost, repeated, wrong_crc, wrong_length;
  uint32_t incomplete; /* epochs with a missing frame */
};

struct bevloc_receiver {
  uint32_t base_id;
  struct bevloc_alert_limits limits;
  struct bevloc_counters counters;
  bool has_status, has_pose;
  uint32_t why;       /* the reasons why the state is not better, as bits: BEVLOC_WHY() */
  int state;          /* BEVLOC_LOC_Status_State_... */
  int time_source;    /* BEVLOC_LOC_Status_TimeSource_... */
  uint16_t map_id;    /* MapId of LOC_Status; compare it with that of your map */
  uint64_t status_us; /* when LOC_Status arrived */
  bool has_clock;
  uint32_t utc_offset_us; /* UTC minus the localizer's clock, modulo 2^32 */
  double utc_error_ms;    /* bound of the error of utc_offset_us */
  uint64_t clock_us;      /* when LOC_Clock arrived */
  struct bevloc_pose pose;
  bool pose_follows_silence; /* the pose is the first one of all, or the first after a timeout */
  /* The members below are internal. */
  int last_counter[16]; /* by id_offset; -1 if there is none */
  uint8_t frames[BEVLOC_PARTS][8];
  unsigned present;
  int epoch;
  uint64_t epoch_us;
};

static inline const struct bevloc_message* bevloc_part(int part) {
  static const struct bevloc_message* const parts[BEVLOC_PARTS] = {
      &BEVLOC_LOC_Time,     &BEVLOC_LOC_Latitude, &BEVLOC_LOC_Longitude, &BEVLOC_LOC_PosLocal,
      &BEVLOC_LOC_Attitude, &BEVLOC_LOC_Velocity, &BEVLOC_LOC_StdDev,    &BEVLOC_LOC_Integrity};
  return parts[part];
}

static inline void bevloc_init(struct bevloc_receiver* receiver, uint32_t base_id,
                               struct bevloc_alert_limits limits) {
  int i;
  memset(receiver, 0, sizeof *receiver);
  receiver->base_id = base_id;
  receiver->limits = limits;
  receiver->epoch = -1;
  for (i = 0; i < 16; ++i) receiver->last_counter[i] = -1;
}

/* Returns the CRC-8H2F over bytes 1 to the last, then the data id. */
static inline uint8_t bevloc_crc8(const uint8_t* data, size_t length, uint8_t data_id) {
  uint8_t crc = 0xFF;
  size_t i;
  int bit;
  for (i = 1; i <= length; ++i) {
    crc = (uint8_t)(crc ^ (i < length ? data[i] : data_id));
    for (bit = 0; bit < 8; ++bit) {
      crc = (uint8_t)((crc & 0x80) != 0 ? (crc << 1) ^ 0x2F : crc << 1);
    }
  }
  return (uint8_t)(crc ^ 0xFF);
}

/* Returns the CRC-16/CCITT-FALSE over bytes 2 to the last, then the data id, low byte first. */
static inline uint16_t bevloc_crc16(const uint8_t* data, size_t length, uint16_t data_id) {
  uint16_t crc = 0xFFFF;
  size_t i;
  int bit;
  for (i = 2; i < length + 2; ++i) {
    const uint8_t byte = i < length ? data[i] : (uint8_t)(data_id >> (i == length ? 0 : 8));
    crc = (uint16_t)(crc ^ (uint16_t)((uint32_t)byte << 8));
    for (bit = 0; bit < 8; ++bit) {
      crc = (uint16_t)((crc & 0x8000) != 0 ? (crc << 1) ^ 0x1021 : crc << 1);
    }
  }
  return crc;
}

/* Decodes a signal. Returns false if it is not available. */
static inline bool bevloc_decode(const uint8_t* data, const struct bevloc_signal* signal,
                                 double* value) {
  uint64_t raw = 0;
  int64_t number;
  unsigned i;
  for (i = 0; i < signal->length_bits; ++i) {
    const unsigned bit = signal->start_bit + i;
    raw |= (uint64_t)(data[bit / 8] >> (bit % 8) & 1) << i;
  }
  number = (int64_t)raw;
  if (signal->is_signed && (raw >> (signal->length_bits - 1) & 1) != 0) {
    number = (int64_t)raw - ((int64_t)1 << signal->length_bits);
  }
  if (signal->has_sna) {
    const int64_t sna = signal->is_signed ? -((int64_t)1 << (signal->length_bits - 1))
                                          : ((int64_t)1 << signal->length_bits) - 1;
    if (number == sna) return false;
  }
  *value = (double)number * signal->scale + signal->offset;
  /* The limits are whole steps, so half a step is enough for rounding. */
  return *value >= signal->min - 0.5 * signal->scale && *value <= signal->max + 0.5 * signal->scale;
}

/* Checks length, checksum and counter of one frame. */
static inline bool bevloc_check(struct bevloc_receiver* receiver,
                                const struct bevloc_message* message, const uint8_t* data,
                                size_t length) {
  int* last = &receiver->last_counter[message->id_offset];
  const int counters = message->is_fd ? 256 : 16;
  int counter;
  bool good;
  if (length != message->length) {
    ++receiver->counters.wrong_length;
    return false;
  }
  good = message->is_fd
             ? bevloc_crc16(data, length, message->data_id) == (data[0] | (uint32_t)data[1] << 8)
             : bevloc_crc8(data, length, (uint8_t)message->data_id) == data[0];
  if (!good) {
    ++receiver->counters.wrong_crc;
    return false;
  }
  counter = message->is_fd ? data[2] : data[1] & 0x0F;
  if (counter == *last) {
    ++receiver->counters.repeated;
    return false;
  }
  if (*last >= 0) {
    receiver->counters.lost += (uint32_t)((counter - *last - 1 + counters) % counters);
  }
  *last = counter;
  ++receiver->counters.ok;
  return true;
}

/* Whether at most `limit_us` passed since a time stamp. Stamps may be out of order by one cycle of
   their message. If a stamp lies further ahead, the clock was set back and its age is unknown. */
static inline bool bevloc_is_fresh(uint64_t now_us, uint64_t stamp_us, uint32_t limit_us,
                                   const struct bevloc_message* message) {
  const int64_t age_us = (int64_t)(now_us - stamp_us);
  return age_us <= (int64_t)limit_us && age_us >= -1000 * (int64_t)message->cycle_ms;
}

/* Whether at most three cycles of the message passed since a time stamp. */
static inline bool bevloc_is_in_time(uint64_t now_us, uint64_t stamp_us,
                                     const struct bevloc_message* message) {
  return bevloc_is_fresh(now_us, stamp_us, (uint32_t)3000 * message->cycle_ms, message);
}

/* The bit of a reason: receiver.why & BEVLOC_WHY(BEVLOC_LOC_Status_Why_GnssMissing). */
#define BEVLOC_WHY(signal) (UINT32_C(1) << ((signal).start_bit - 32))

/* Takes the reasons of a frame, from the first to the last one. */
static inline void bevloc_take_why(struct bevloc_receiver* receiver, const uint8_t* data,
                                   const struct bevloc_signal* first,
                                   const struct bevloc_signal* last) {
  const uint32_t mask = 2 * BEVLOC_WHY(*last) - BEVLOC_WHY(*first);
  const uint32_t low = data[4] | (uint32_t)data[5] << 8;
  const uint32_t high = data[6] | (uint32_t)data[7] << 8;
  receiver->why = (receiver->why & ~mask) | ((low | high << 16) & mask);
}

/* Returns false, because LOC_Status completes no pose. LOC_Clock does not either. */
static inline bool bevloc_take_status(struct bevloc_receiver* receiver, const uint8_t* data,
                                      uint64_t now_us) {
  double value = 0;
  if (!bevloc_decode(data, &BEVLOC_LOC_Status_TimeSource, &value)) {
    value = BEVLOC_LOC_Status_TimeSource_FREE_RUNNING;
  }
  receiver->time_source = (int)value;
  if (bevloc_decode(data, &BEVLOC_LOC_Status_MapId, &value)) receiver->map_id = (uint16_t)value;
  if (!bevloc_decode(data, &BEVLOC_LOC_Status_State, &value)) value = BEVLOC_LOC_Status_State_FAULT;
  receiver->state = (int)value;
  bevloc_take_why(receiver, data, &BEVLOC_LOC_Status_Why_CameraMissing,
                  &BEVLOC_LOC_Status_Why_InternalFault);
  receiver->has_status = true;
  receiver->status_us = now_us;
  return false;
}

static inline bool bevloc_take_clock(struct bevloc_receiver* receiver, const uint8_t* data,
                                     uint64_t now_us) {
  double offset_us = 0;
  receiver->has_clock = bevloc_decode(data, &BEVLOC_LOC_Clock_UtcOffset, &offset_us) &&
                        bevloc_decode(data, &BEVLOC_LOC_Clock_UtcError, &receiver->utc_error_ms);
  receiver->utc_offset_us = (uint32_t)offset_us;
  receiver->clock_us = now_us;
  return false;
}

static inline void bevloc_take_pose(struct bevloc_receiver* receiver, uint64_t now_us) {
  struct bevloc_pose* pose = &receiver->pose;
  uint8_t(*frames)[8] = receiver->frames;
  double risk = 0, capture_us = 0;
  bool complete = true;
  /* When the bus returns after a failure, the first pose may be an old one that waited in the
     sender's controller. At most one can wait. */
  receiver->pose_follows_silence =
      !receiver->has_pose || !bevloc_is_in_time(now_us, pose->received_us, &BEVLOC_LOC_Time);
  memset(pose, 0, sizeof *pose);
  pose->has_capture = bevloc_decode(frames[0], &BEVLOC_LOC_Time_CaptureAge, &pose->age_ms) &&
                      bevloc_decode(frames[0], &BEVLOC_LOC_Time_CaptureTime, &capture_us);
  complete &= pose->has_capture;
  pose->capture_us = (uint32_t)capture_us;
  complete &= bevloc_decode(frames[1], &BEVLOC_LOC_Latitude_Latitude, &pose->latitude_deg);
  complete &= bevloc_decode(frames[2], &BEVLOC_LOC_Longitude_Longitude, &pose->longitude_deg);
  complete &= bevloc_decode(frames[3], &BEVLOC_LOC_PosLocal_LocalEast, &pose->east_m);
  complete &= bevloc_decode(frames[3], &BEVLOC_LOC_PosLocal_LocalNorth, &pose->north_m);
  complete &= bevloc_decode(frames[4], &BEVLOC_LOC_Attitude_Heading, &pose->heading_deg);
  complete &= bevloc_decode(frames[5], &BEVLOC_LOC_Velocity_VelocityX, &pose->speed_mps);
  pose->has_lateral =
      bevloc_decode(frames[7], &BEVLOC_LOC_Integrity_ProtectionLateral, &pose->lateral_m);
  pose->has_longitudinal =
      bevloc_decode(frames[7], &BEVLOC_LOC_Integrity_ProtectionLongitudinal, &pose->longitudinal_m);
  pose->has_yaw = bevloc_decode(frames[7], &BEVLOC_LOC_Integrity_ProtectionYaw, &pose->yaw_deg);
  complete &= bevloc_decode(frames[7], &BEVLOC_LOC_Integrity_IntegrityRiskExponent, &risk);
  pose->risk_exponent = (int)risk;
  bevloc_take_why(receiver, frames[7], &BEVLOC_LOC_Integrity_Why_GnssContradicts,
                  &BEVLOC_LOC_Integrity_Why_ForeignSender);
  pose->foreign_sender = (receiver->why & BEVLOC_WHY(BEVLOC_LOC_Integrity_Why_ForeignSender)) != 0;
  pose->complete = complete;
  pose->received_us = now_us;
  receiver->has_pose = true;
}

/* Adds one checked frame of a pose. Returns true when the pose is complete. */
static inline bool bevloc_take_part(struct bevloc_receiver* receiver, int part, int epoch,
                                    const uint8_t* data, size_t length, uint64_t now_us) {
  const bool continues = epoch == receiver->epoch && (receiver->present >> part & 1) == 0 &&
                         bevloc_is_fresh(now_us, receiver->epoch_us, 39999, &BEVLOC_LOC_Time);
  if (!continues) {
    if (receiver->present != 0) ++receiver->counters.incomplete;
    receiver->present = 0;
    receiver->epoch = epoch;
    receiver->epoch_us = now_us;
  }
  memcpy(receiver->frames[part], data, length);
  receiver->present |= 1u << part;
  if (receiver->present != (1u << BEVLOC_PARTS) - 1) return false;
  receiver->present = 0;
  bevloc_take_pose(receiver, now_us);
  return true;
}

/* Takes LOC_Solution apart into the contents of the classic messages. */
static inline bool bevloc_take_solution(struct bevloc_receiver* receiver, const uint8_t* data,
                                        uint64_t now_us) {
  uint8_t status[8] = {0};
  int part;
  memcpy(status + 2, data + BEVLOC_LOC_Status.fd_first_byte, BEVLOC_LOC_Status.length - 2u);
  bevloc_take_status(receiver, status, now_us);
  for (part = 0; part < BEVLOC_PARTS; ++part) {
    const struct bevloc_message* message = bevloc_part(part);
    memcpy(receiver->frames[part] + 2, data + message->fd_first_byte, message->length - 2u);
  }
  bevloc_take_pose(receiver, now_us);
  return true;
}

/* Takes any frame. `now_us` says when it arrived, not when you read it, on your clock. Returns
   whether the frame completes a pose. */
static inline bool bevloc_receive(struct bevloc_receiver* receiver, uint32_t id,
                                  const uint8_t* data, size_t length, uint64_t now_us) {
  int part;
  const uint32_t offset = id - receiver->base_id;
  if (offset == BEVLOC_LOC_Status.id_offset) {
    return bevloc_check(receiver, &BEVLOC_LOC_Status, data, length) &&
           bevloc_take_status(receiver, data, now_us);
  }
  if (offset == BEVLOC_LOC_Clock.id_offset) {
    return bevloc_check(receiver, &BEVLOC_LOC_Clock, data, length) &&
           bevloc_take_clock(receiver, data, now_us);
  }
  if (offset == BEVLOC_LOC_Solution.id_offset) {
    return bevloc_check(receiver, &BEVLOC_LOC_Solution, data, length) &&
           bevloc_take_solution(receiver, data, now_us);
  }
  for (part = 0; part < BEVLOC_PARTS; ++part) {
    const struct bevloc_message* message = bevloc_part(part);
    if (offset != message->id_offset) continue;
    return bevloc_check(receiver, message, data, length) &&
           bevloc_take_part(receiver, part, data[1] >> 4, data, length, now_us);
  }
  return false;
}

/* No level is beyond a limit of 0. Every level is beyond a negative limit or one that is NaN. */
static inline bool bevloc_is_beyond(double limit, double level) {
  return limit != 0 && !(level <= limit);
}

/* Says whether the latest pose may be used now, and if not, why. */
static inline enum bevloc_answer bevloc_answer(const struct bevloc_receiver* receiver,
                                               uint64_t now_us) {
  const struct bevloc_pose* pose = &receiver->pose;
  const struct bevloc_alert_limits* limits = &receiver->limits;
  if (!receiver->has_pose || !receiver->has_status) return BEVLOC_NO_POSE;
  if (receiver->pose_follows_silence) return BEVLOC_TIMEOUT;
  if (!bevloc_is_in_time(now_us, pose->received_us, &BEVLOC_LOC_Time)) return BEVLOC_TIMEOUT;
  if (!bevloc_is_in_time(now_us, receiver->status_us, &BEVLOC_LOC_Status)) return BEVLOC_TIMEOUT;
  if (receiver->state != BEVLOC_LOC_Status_State_TRACKING &&
      receiver->state != BEVLOC_LOC_Status_State_DEGRADED) {
    return BEVLOC_NOT_VALID;
  }
  if (pose->foreign_sender) return BEVLOC_FOREIGN_SENDER;
  if (!pose->complete || (limits->lateral_m != 0 && !pose->has_lateral) ||
      (limits->longitudinal_m != 0 && !pose->has_longitudinal) ||
      (limits->yaw_deg != 0 && !pose->has_yaw)) {
    return BEVLOC_NOT_AVAILABLE;
  }
  if (bevloc_is_beyond(limits->lateral_m, pose->lateral_m) ||
      bevloc_is_beyond(limits->longitudinal_m, pose->longitudinal_m) ||
      bevloc_is_beyond(limits->yaw_deg, pose->yaw_deg) ||
      pose->risk_exponent < limits->risk_exponent) {
    return BEVLOC_BEYOND_LIMIT;
  }
  return BEVLOC_USABLE;
}

/* Computes when the images of the latest pose were taken (age_ms before it), in UTC modulo 2^32 us.
   Returns false without images or a fresh LOC_Clock, or if the localizer does not know UTC. */
static inline bool bevloc_capture_utc(const struct bevloc_receiver* receiver, uint64_t now_us,
                                      uint32_t* utc_us) {
  if (!receiver->has_clock || !receiver->has_pose || !receiver->pose.has_capture) return false;
  if (!bevloc_is_in_time(now_us, receiver->clock_us, &BEVLOC_LOC_Clock)) return false;
  *utc_us = receiver->pose.capture_us + receiver->utc_offset_us;
  return true;
}

static inline const char* bevloc_answer_name(enum bevloc_answer answer) {
  static const char* const names[] = {"usable",         "no_pose",       "timeout",     "not_valid",
                                      "foreign_sender", "not_available", "beyond_limit"};
  return (unsigned)answer < sizeof names / sizeof *names ? names[answer] : "";
}

#endif
