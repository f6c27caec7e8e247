// What goes over the wire between slidepipe and the bridge on the WAM's control PC: see wam_codec.py, which this
// must agree with. Plain C++11 without any library, so that it is tested where no WAM is.
#ifndef SLIDEPIPE_PACKET_H
#define SLIDEPIPE_PACKET_H

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace slidepipe {

const int JOINTS = 7;
const std::size_t PACKET_BYTES = 200;
const std::uint8_t VERSION = 1, COMMAND = 1, STATE = 2;
const std::uint8_t LINKED = 1, FAULT = 2;

// Angles in rad, speeds in rad/s, torques beyond gravity (commands) or applied (states) in N m.
struct Packet {
  std::uint8_t kind;
  std::uint8_t flags;
  std::uint32_t sequence;
  std::uint64_t time_ns;
  double gripper_n;
  std::uint32_t answers;
  double position[JOINTS], velocity[JOINTS], torque[JOINTS];
};

// Bytes are written one by one, lowest first: right on any machine.
inline void put(std::uint8_t *at, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) at[i] = static_cast<std::uint8_t>(value >> (8 * i));
}

inline std::uint64_t get(const std::uint8_t *at, int bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) value |= static_cast<std::uint64_t>(at[i]) << (8 * i);
  return value;
}

inline void put_double(std::uint8_t *at, double value) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, 8);
  put(at, bits, 8);
}

inline double get_double(const std::uint8_t *at) {
  std::uint64_t bits = get(at, 8);
  double value;
  std::memcpy(&value, &bits, 8);
  return value;
}

inline void encode(const Packet &packet, std::uint8_t *out) {
  std::memcpy(out, "SPWB", 4);
  out[4] = VERSION;
  out[5] = packet.kind;
  out[6] = packet.flags;
  out[7] = 0;
  put(out + 8, packet.sequence, 4);
  put(out + 12, packet.time_ns, 8);
  put_double(out + 20, packet.gripper_n);
  put(out + 28, packet.answers, 4);
  const double *columns[3] = {packet.position, packet.velocity, packet.torque};
  for (int column = 0; column < 3; ++column)
    for (int joint = 0; joint < JOINTS; ++joint)
      put_double(out + 32 + 8 * (JOINTS * column + joint), columns[column][joint]);
}

// False where the bytes are no packet of the kind that is wanted, or hold a number that is not finite.
inline bool decode(const std::uint8_t *in, std::size_t size, std::uint8_t wanted, Packet *packet) {
  if (size != PACKET_BYTES || std::memcmp(in, "SPWB", 4) != 0 || in[4] != VERSION || in[5] != wanted) return false;
  packet->kind = in[5];
  packet->flags = in[6];
  packet->sequence = static_cast<std::uint32_t>(get(in + 8, 4));
  packet->time_ns = get(in + 12, 8);
  packet->gripper_n = get_double(in + 20);
  packet->answers = static_cast<std::uint32_t>(get(in + 28, 4));
  double *columns[3] = {packet->position, packet->velocity, packet->torque};
  bool finite = std::isfinite(packet->gripper_n);
  for (int column = 0; column < 3; ++column)
    for (int joint = 0; joint < JOINTS; ++joint) {
      columns[column][joint] = get_double(in + 32 + 8 * (JOINTS * column + joint));
      finite = finite && std::isfinite(columns[column][joint]);
    }
  return finite;
}

}  // namespace slidepipe

#endif
