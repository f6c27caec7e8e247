// slidepipe's bridge on the WAM's control PC: follows commands of angles, speeds and torques, and tells what it measures.
//
// A program of its own, because libbarrett is under the GPL: nothing of slidepipe is linked into it. It was written from
// the library's sources and was never run on an arm: try it first with the arm held by two people and the E-stop in hand.
//
//   g++ -std=c++11 -O2 bridge.cpp -o slidepipe-bridge $(pkg-config --cflags --libs barrett) -lpthread
//   ./slidepipe-bridge 192.168.139.2 5555 192.168.139.1 5555      (our address and port, then slidepipe's)
//
// What it does, every 2 ms, in the library's own loop:
//   - takes what arrived and follows the command whose turn it is (playout.h), its torque beyond gravity on top of the
//     library's position control and gravity compensation;
//   - links only where the stream is within NEAR_RAD of the arm, for LINK_TICKS, after a person has pressed Enter;
//   - after MISSED_TICKS without a datagram lets go: the reference follows the measured pose, the torque is zero, and it
//     does not link again until Enter is pressed once more;
//   - clips torque and refuses steps that no arm could make, and then lets go as well, with the flag FAULT.
#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <barrett/products/product_manager.h>
#include <barrett/systems.h>
#include <barrett/units.h>
#define BARRETT_SMF_VALIDATE_ARGS
#include <barrett/standard_main_function.h>

#include "playout.h"

using namespace barrett;

const double NEAR_RAD = 0.1, STEP_RAD = 0.03;
const int LINK_TICKS = 100, MISSED_TICKS = 10;
const double TORQUE_CLIP[slidepipe::JOINTS] = {60.0, 60.0, 45.0, 25.0, 10.0, 10.0, 2.5};

struct Peer {
  const char *local_host, *remote_host;
  int local_port, remote_port;
};

static Peer peer;

bool validate_args(int argc, char **argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: %s LOCAL_HOST LOCAL_PORT REMOTE_HOST REMOTE_PORT\n", argv[0]);
    return false;
  }
  peer.local_host = argv[1];
  peer.local_port = std::atoi(argv[2]);
  peer.remote_host = argv[3];
  peer.remote_port = std::atoi(argv[4]);
  return true;
}

static int connected_socket() {
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in local = {}, remote = {};
  local.sin_family = remote.sin_family = AF_INET;
  local.sin_port = htons(static_cast<uint16_t>(peer.local_port));
  remote.sin_port = htons(static_cast<uint16_t>(peer.remote_port));
  if (fd < 0 || inet_pton(AF_INET, peer.local_host, &local.sin_addr) != 1 ||
      inet_pton(AF_INET, peer.remote_host, &remote.sin_addr) != 1 ||
      bind(fd, reinterpret_cast<sockaddr *>(&local), sizeof local) != 0 ||
      connect(fd, reinterpret_cast<sockaddr *>(&remote), sizeof remote) != 0 ||
      fcntl(fd, F_SETFL, O_NONBLOCK) != 0) {
    std::perror("slidepipe-bridge: cannot open the link");
    std::exit(1);
  }
  return fd;
}

static std::uint64_t now_ns() {
  timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return 1000000000ull * static_cast<std::uint64_t>(now.tv_sec) + static_cast<std::uint64_t>(now.tv_nsec);
}

// Measured angles and speeds in, reference angles and torques beyond gravity out, once a tick.
template <size_t DOF>
class Bridge : public systems::System {
  BARRETT_UNITS_TEMPLATE_TYPEDEFS(DOF);

 public:
  Input<jp_type> measured;
  Input<jv_type> speed;
  Output<jp_type> reference;
  Output<jt_type> torque;

  Bridge(systems::ExecutionManager *em, int fd)
      : System("slidepipe::Bridge"), measured(this), speed(this), reference(this, &referenceValue_),
        torque(this, &torqueValue_), wanted(false), fd_(fd), linked_(false), fault_(false), missed_(0), near_(0), sent_(0),
        answers_(0) {
    if (em != NULL) em->startManaging(*this);
  }
  virtual ~Bridge() { mandatoryCleanUp(); }

  std::atomic<bool> wanted;  // a person has pressed Enter

 protected:
  typename Output<jp_type>::Value *referenceValue_;
  typename Output<jt_type>::Value *torqueValue_;

  virtual void operate() {
    const jp_type &at = measured.getValue();
    missed_ = receive() ? 0 : missed_ + 1;
    slidepipe::Packet command;
    const bool there = playout_.take(&command);
    if (linked_ && missed_ >= MISSED_TICKS) letGo(false);
    if (there) follow(command, at);
    if (!linked_) {
      jp_ = at;
      jt_.setZero();
    } else if (!there) {
      jp_ += 0.002 * jv_;
    }
    referenceValue_->setData(&jp_);
    torqueValue_->setData(&jt_);
    tell(at);
  }

 private:
  bool receive() {
    std::uint8_t bytes[slidepipe::PACKET_BYTES + 1];
    slidepipe::Packet command;
    bool heard = false;
    for (int i = 0; i < 64; ++i) {
      const ssize_t size = recv(fd_, bytes, sizeof bytes, 0);
      if (size < 0) break;
      if (!slidepipe::decode(bytes, static_cast<size_t>(size), slidepipe::COMMAND, &command)) continue;
      playout_.put(command);
      answers_ = command.sequence;
      heard = true;
    }
    return heard;
  }

  void follow(const slidepipe::Packet &command, const jp_type &at) {
    double farthest = 0.0, step = 0.0;
    for (int j = 0; j < slidepipe::JOINTS; ++j) {
      farthest = std::max(farthest, std::fabs(command.position[j] - at[j]));
      step = std::max(step, std::fabs(command.position[j] - jp_[j]));
    }
    near_ = farthest < NEAR_RAD ? near_ + 1 : 0;
    if (!linked_ && wanted && near_ >= LINK_TICKS) {
      linked_ = true;
      fault_ = wanted = false;
    } else if (linked_ && step > STEP_RAD) {
      letGo(true);
    }
    if (!linked_) return;
    for (int j = 0; j < slidepipe::JOINTS; ++j) {
      jp_[j] = command.position[j];
      jv_[j] = command.velocity[j];
      jt_[j] = std::max(-TORQUE_CLIP[j], std::min(TORQUE_CLIP[j], command.torque[j]));
    }
  }

  void letGo(bool fault) {
    linked_ = false;
    fault_ = fault;
    near_ = 0;
  }

  void tell(const jp_type &at) {
    slidepipe::Packet state = {};
    state.kind = slidepipe::STATE;
    state.flags = static_cast<std::uint8_t>((linked_ ? slidepipe::LINKED : 0) | (fault_ ? slidepipe::FAULT : 0));
    state.sequence = sent_++;
    state.time_ns = now_ns();
    state.answers = answers_;
    for (int j = 0; j < slidepipe::JOINTS; ++j) {
      state.position[j] = at[j];
      state.velocity[j] = speed.getValue()[j];
      state.torque[j] = jt_[j];
    }
    std::uint8_t bytes[slidepipe::PACKET_BYTES];
    slidepipe::encode(state, bytes);
    if (send(fd_, bytes, sizeof bytes, 0) < 0) return;  // one that is lost is one that is lost
  }

  const int fd_;
  slidepipe::Playout playout_;
  jp_type jp_;
  jv_type jv_;
  jt_type jt_;
  bool linked_, fault_;
  int missed_, near_;
  std::uint32_t sent_, answers_;
};

template <size_t DOF>
int wam_main(int, char **, ProductManager &pm, systems::Wam<DOF> &wam) {
  if (DOF != slidepipe::JOINTS) {
    std::fprintf(stderr, "slidepipe-bridge: needs a WAM of %d joints, this one has %zu\n", slidepipe::JOINTS, DOF);
    return 1;
  }
  Bridge<DOF> bridge(pm.getExecutionManager(), connected_socket());
  systems::connect(wam.jpOutput, bridge.measured);
  systems::connect(wam.jvOutput, bridge.speed);
  wam.gravityCompensate();
  systems::connect(bridge.torque, wam.input);
  wam.trackReferenceSignal(bridge.reference);
  std::printf("slidepipe-bridge: Enter links the arm once slidepipe streams its pose; Shift-idle ends.\n");
  while (pm.getSafetyModule()->getMode() == SafetyModule::ACTIVE) {
    fd_set stdin_only;
    timeval patience = {0, 100000};
    FD_ZERO(&stdin_only);
    FD_SET(0, &stdin_only);
    if (select(1, &stdin_only, NULL, NULL, &patience) > 0 && std::getchar() == '\n') bridge.wanted = true;
  }
  pm.getSafetyModule()->waitForMode(SafetyModule::IDLE);
  return 0;
}
