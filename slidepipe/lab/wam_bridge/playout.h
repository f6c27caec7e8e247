// Which command is followed in a tick: each a fixed time after its own, whatever the network did to it. The same rules as
// playout.py; no allocation, for it runs in the control loop.
#ifndef SLIDEPIPE_PLAYOUT_H
#define SLIDEPIPE_PLAYOUT_H

#include "packet.h"

namespace slidepipe {

class Playout {
 public:
  static const int SLOTS = 64, DELAY_TICKS = 3, LATE_IN_A_ROW = 5;
  static const std::int64_t STRANGE = 1000;

  Playout() : due_(0), begun_(false), late_(0) { clear(); }

  void put(const Packet &command) {
    const std::int64_t number = command.sequence, ahead = number - due_;
    if (!begun_ || ahead > STRANGE || ahead < -STRANGE) begin(number);
    late_ = number < due_ ? late_ + 1 : 0;
    if (late_ > LATE_IN_A_ROW) begin(number);
    if (number >= due_) keep(command);
  }

  // The command of the tick that begins; false where there is none.
  bool take(Packet *command) {
    if (!begun_) return false;
    const int slot = static_cast<int>((due_ + SLOTS) % SLOTS);
    const bool there = due_ >= 0 && held_[slot] == due_;
    if (there) {
      *command = slots_[slot];
      held_[slot] = -1;
    }
    ++due_;
    return there;
  }

 private:
  void begin(std::int64_t number) {
    due_ = number - DELAY_TICKS;
    begun_ = true;
    late_ = 0;
    clear();
  }

  void keep(const Packet &command) {
    if (command.sequence - due_ >= SLOTS) return;
    const int slot = static_cast<int>(command.sequence % SLOTS);
    slots_[slot] = command;
    held_[slot] = command.sequence;
  }

  void clear() {
    for (int i = 0; i < SLOTS; ++i) held_[i] = -1;
  }

  Packet slots_[SLOTS];
  std::int64_t held_[SLOTS], due_;
  bool begun_;
  int late_;
};

}  // namespace slidepipe

#endif
