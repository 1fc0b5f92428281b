// Finds the signals of a configuration in a DBC file, and checks that each can carry its quantity.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "can/dbc/dbc.h"
#include "can/vehicle/units.h"
#include "can/vehicle/vehicle_binding.h"

namespace bevloc::can {

/// Why a value of the configuration cannot be used: "found X, wanted Y".
struct Refusal {
  std::string found;
  std::string wanted;
  std::string key{};  ///< which of several keys has the value; empty if it is the first one
};
template <typename T>
using Bound = tl::expected<T, Refusal>;

inline tl::unexpected<Refusal> refusal(std::string found, std::string wanted,
                                       std::string key = {}) {
  return tl::unexpected(Refusal{std::move(found), std::move(wanted), std::move(key)});
}

/// What the configuration says about the protection of a message.
struct ProtectionRequest {
  std::string message;
  std::optional<double> cycle_ms{};
  std::string counter{};                      ///< name of the signal; empty if there is none
  std::optional<uint32_t> highest_counter{};  ///< by default, all bits of the counter are set
  std::string checksum{};                     ///< name of the signal; empty if there is none
  std::optional<ChecksumKind> kind{};
  std::vector<uint16_t> data_ids{};

  /// Whether this says how the message is protected. If it does not, the attributes of the DBC file
  /// do.
  bool replaces_attributes() const { return kind || !counter.empty(); }
};

/// Fills a VehicleBinding. Signals are named "Signal" or "Message.Signal". Misspelt names are
/// refused with the one that was probably meant. One thread.
class VehicleBinder {
 public:
  /// `dbc` must outlive this.
  explicit VehicleBinder(const Dbc& dbc) : dbc_(dbc) { binding_.dbc_file = dbc.file; }

  Bound<std::string> message_name(const std::string& name) const;

  /// Binds a signal that carries this quantity, and returns its index in the binding. `unit`
  /// replaces the unit of the DBC file unless it is empty. Refuses units that are not known, and
  /// ranges and steps that no signal of this quantity has. Refuses a second value from one signal,
  /// except for lengths.
  Bound<size_t> quantity(const std::string& signal, const std::string& default_message,
                         Quantity quantity, const std::string& unit);

  /// The values are raw numbers or names of VAL_. A name means all values that have it.
  Bound<BoundCondition> condition(const std::string& signal, const std::string& default_message,
                                  const std::vector<std::string>& values);

  /// Refuses a second request for a message.
  Bound<void> protect(const ProtectionRequest& request);

  VehicleBinding& binding() { return binding_; }

  /// Says what is wrong with a message.
  struct MessageRefusal {
    std::string message;
    Refusal refusal;
  };

  /// Call it last: completes protection from the attributes of the DBC file, and checks cycles,
  /// lengths, and that each value, counter and checksum has bits of its own.
  tl::expected<VehicleBinding, MessageRefusal> finish();

 private:
  Bound<const DbcSignal*> find(const std::string& signal, const std::string& default_message,
                               const DbcMessage*& message) const;
  size_t bind(const DbcMessage& message, const DbcSignal& signal);
  size_t bind_message(const DbcMessage& message);
  const ProtectionRequest* request_of(const std::string& message) const;
  Bound<const DbcSignal*> protecting(const std::string& signal, const std::string& message,
                                     const std::string& key) const;
  Bound<void> set_counter(const ProtectionRequest& request, MessageProtection& protection) const;
  Bound<void> finish_message(BoundMessage& message);
  Bound<void> check_places(const BoundMessage& message) const;
  Bound<void> check_values(const BoundMessage& message) const;
  Bound<void> protect_by_attributes(const DbcMessage& dbc, BoundMessage& message) const;
  void mark_odometry();

  const Dbc& dbc_;
  VehicleBinding binding_;
  std::map<size_t, Quantity> quantities_;  ///< quantities of the signals that carry a value
  std::vector<ProtectionRequest> requests_;
};

}  // namespace bevloc::can
