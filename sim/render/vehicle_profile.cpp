#include "sim/render/vehicle_profile.h"

#include <array>

namespace bevloc::sim {
namespace {

constexpr std::array<ProfileCorner, 9> kCar = {{{0.0F, 0.17F, Pattern::kVehicleRear},
                                                {0.0F, 0.60F, Pattern::kPlain},
                                                {0.13F, 0.66F, Pattern::kGlass},
                                                {0.28F, 0.97F, Pattern::kPlain},
                                                {0.58F, 1.0F, Pattern::kGlass},
                                                {0.75F, 0.66F, Pattern::kPlain},
                                                {0.97F, 0.55F, Pattern::kPlain},
                                                {1.0F, 0.48F, Pattern::kVehicleFront},
                                                {1.0F, 0.17F, Pattern::kPlain}}};
constexpr std::array<ProfileCorner, 7> kVan = {{{0.0F, 0.14F, Pattern::kVehicleRear},
                                                {0.0F, 0.95F, Pattern::kPlain},
                                                {0.03F, 1.0F, Pattern::kPlain},
                                                {0.72F, 0.99F, Pattern::kGlass},
                                                {0.86F, 0.60F, Pattern::kPlain},
                                                {1.0F, 0.48F, Pattern::kVehicleFront},
                                                {1.0F, 0.14F, Pattern::kPlain}}};
constexpr std::array<ProfileCorner, 8> kTruck = {{{0.0F, 0.12F, Pattern::kVehicleRear},
                                                  {0.0F, 1.0F, Pattern::kPlain},
                                                  {0.76F, 1.0F, Pattern::kPlain},
                                                  {0.765F, 0.80F, Pattern::kPlain},
                                                  {0.96F, 0.80F, Pattern::kGlass},
                                                  {0.985F, 0.50F, Pattern::kPlain},
                                                  {1.0F, 0.45F, Pattern::kVehicleFront},
                                                  {1.0F, 0.12F, Pattern::kPlain}}};
constexpr std::array<ProfileCorner, 6> kBus = {{{0.0F, 0.10F, Pattern::kVehicleRear},
                                                {0.0F, 1.0F, Pattern::kPlain},
                                                {0.985F, 1.0F, Pattern::kGlass},
                                                {1.0F, 0.40F, Pattern::kVehicleFront},
                                                {1.0F, 0.10F, Pattern::kPlain},
                                                {0.5F, 0.10F, Pattern::kPlain}}};

constexpr std::array<VehicleProfile, 4> kProfiles = {{{kCar, Pattern::kCarSide},
                                                      {kVan, Pattern::kVanSide},
                                                      {kTruck, Pattern::kTruckSide},
                                                      {kBus, Pattern::kBusSide}}};

}  // namespace

const VehicleProfile& profile_of(VehicleKind kind) {
  return kProfiles[static_cast<size_t>(kind)];
}

bool inside_profile(std::span<const ProfileCorner> corners, float x, float z) {
  bool inside = false;
  for (size_t i = 0; i < corners.size(); ++i) {
    const ProfileCorner& a = corners[i];
    const ProfileCorner& b = corners[(i + 1) % corners.size()];
    if ((a.z > z) != (b.z > z) && x < a.x + (b.x - a.x) * (z - a.z) / (b.z - a.z)) inside = !inside;
  }
  return inside;
}

}  // namespace bevloc::sim
