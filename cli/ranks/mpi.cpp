// Implements ranks by MPI. A text is sent as its number of bytes, followed by the bytes in blocks whose size MPI can
// count. An error is sent as one text. A rank that waits sleeps between polls, because the ranks of one machine share
// its cores. While it waits, it also looks for errors: the first rank looks for errors of the other ranks, and the
// other ranks look for the first rank's message that all ranks must end.
//
// The first rank must send this message itself. mpirun would send SIGTERM, and soon afterwards SIGKILL. Open MPI should
// wait a second in between, but the signal that a rank has ended cuts this time short for all other ranks. On a busy
// machine, ranks were killed before they had removed their files.
#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <thread>
#include <utility>

#include "chronormal/io/output.h"
#include "cli/ranks/ranks.h"
#include "cli/terminal/format.h"
#include "cli/terminal/print.h"

namespace chronormal::cli {
namespace {

constexpr int kFirst = 0;
constexpr int kText = 1, kError = 2, kEnd = 3, kReady = 4;  // kinds of messages between ranks
constexpr std::uint64_t kBlock = std::uint64_t{1} << 30U;
constexpr std::chrono::milliseconds kNap{1};
// The time that the other ranks get to notice the first rank's message that all ranks must end. Ranks look for this
// message only now and then.
constexpr std::chrono::seconds kGrace{5};

struct State {
  int rank = 0, count = 1;
  std::function<int(const Error&)> report;
};

State& state() {
  static State the_state;
  return the_state;
}

bool is_first() { return state().rank == kFirst; }

// Returns true if this process is a rank. Open MPI's mpirun, every launcher with PMIx (srun, Open MPI 5) and every
// launcher with PMI (MPICH, Intel MPI) set one of these variables for each rank.
bool was_started_as_rank() {
  constexpr const char* kVariables[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"};
  return std::any_of(std::begin(kVariables), std::end(kVariables),
                     [](const char* name) { return std::getenv(name) != nullptr; });
}

// Receives a message of the given kind from the rank `from`, if one has arrived. Returns true if it received a message.
bool take_signal(int from, int kind) {
  int is_there = 0;
  MPI_Iprobe(from, kind, MPI_COMM_WORLD, &is_there, MPI_STATUS_IGNORE);
  if (is_there != 0) MPI_Recv(nullptr, 0, MPI_BYTE, from, kind, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return is_there != 0;
}

// Tells the other ranks to end. Returns when all of them have removed their files, or after kGrace.
void end_others() {
  for (int rank = 1; rank < state().count; ++rank) {
    // No one waits for this request, since the receiver may never look for messages.
    MPI_Request request{};
    MPI_Isend(nullptr, 0, MPI_BYTE, rank, kEnd, MPI_COMM_WORLD, &request);
    MPI_Request_free(&request);
  }
  const auto end = std::chrono::steady_clock::now() + kGrace;
  for (int ready = 1; ready < state().count && std::chrono::steady_clock::now() < end;) {
    if (take_signal(MPI_ANY_SOURCE, kReady))
      ++ready;
    else
      std::this_thread::sleep_for(kNap);
  }
}

// Reports an error and ends all ranks. mpirun sends signals to ranks that do not answer.
[[noreturn]] void end_all(const Error& error) {
  const int code = state().report(error);
  remove_temporaries();
  end_others();
  (void)MPI_Abort(MPI_COMM_WORLD, code);
  std::_Exit(code);
}

// Ends this rank if the first rank has told all ranks to end. Removes the temporary files of this rank, tells the first
// rank that they are gone, and waits until mpirun ends the process.
void look_for_end() {
  if (!take_signal(kFirst, kEnd)) return;
  remove_temporaries();
  MPI_Send(nullptr, 0, MPI_BYTE, kFirst, kReady, MPI_COMM_WORLD);
  for (;;) std::this_thread::sleep_for(kGrace);
}

void look_for_errors();

void wait(MPI_Request& request) {
  for (int done = 0;;) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done != 0) return;
    look_for_errors();
    std::this_thread::sleep_for(kNap);
  }
}

// Passes the bytes to move(data, size) in blocks. Each call begins an operation of MPI, and wait() waits for its end.
template <class Byte, class Move>
void move_blocks(std::span<Byte> bytes, const Move& move) {
  while (!bytes.empty()) {
    const std::size_t size = static_cast<std::size_t>(std::min<std::uint64_t>(bytes.size(), kBlock));
    MPI_Request request = move(bytes.data(), static_cast<int>(size));
    wait(request);
    bytes = bytes.subspan(size);
  }
}

void send_text(const std::string& text) {
  std::uint64_t size = text.size();
  MPI_Request request{};
  MPI_Isend(&size, 1, MPI_UINT64_T, kFirst, kText, MPI_COMM_WORLD, &request);
  wait(request);
  move_blocks(std::span(text), [&](const char* data, int bytes) {
    MPI_Isend(data, bytes, MPI_BYTE, kFirst, kText, MPI_COMM_WORLD, &request);
    return request;
  });
}

std::string receive_text(int from) {
  std::uint64_t size = 0;
  MPI_Request request{};
  MPI_Irecv(&size, 1, MPI_UINT64_T, from, kText, MPI_COMM_WORLD, &request);
  wait(request);
  std::string text(static_cast<std::size_t>(size), '\0');
  move_blocks(std::span(text), [&](char* data, int bytes) {
    MPI_Irecv(data, bytes, MPI_BYTE, from, kText, MPI_COMM_WORLD, &request);
    return request;
  });
  return text;
}

// Converts an error to a text: its code, its place and its message, with zero bytes in between.
std::string text_of(const Error& error) {
  return formatted("{}", static_cast<int>(error.code)) + '\0' + error.place + '\0' + error.message;
}

Error error_of(const std::string& text) {
  const std::size_t place = text.find('\0') + 1, message = text.find('\0', place) + 1;
  return {static_cast<ErrorCode>(std::atoi(text.c_str())), text.substr(place, message - place - 1),
          text.substr(message)};
}

// Adds the number of the rank to an error. Usage errors get no number, because every rank has the same usage errors.
Error of_rank(int rank, Error error) {
  if (error.code != ErrorCode::kUsage)
    error.place = formatted("rank {}{}{}", rank, error.place.empty() ? "" : ": ", error.place);
  return error;
}

void look_for_errors() {
  if (!is_first()) {
    look_for_end();
    return;
  }
  MPI_Status message{};
  int is_there = 0, size = 0;
  MPI_Iprobe(MPI_ANY_SOURCE, kError, MPI_COMM_WORLD, &is_there, &message);
  if (is_there == 0) return;
  MPI_Get_count(&message, MPI_BYTE, &size);
  std::string text(static_cast<std::size_t>(size), '\0');
  MPI_Recv(text.data(), size, MPI_BYTE, message.MPI_SOURCE, kError, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  end_all(of_rank(message.MPI_SOURCE, error_of(text)));
}

[[noreturn]] void fail(const Error& error) {
  if (is_first()) end_all(of_rank(kFirst, error));
  const std::string text = text_of(error);
  MPI_Request request{};
  MPI_Isend(text.data(), static_cast<int>(text.size()), MPI_BYTE, kFirst, kError, MPI_COMM_WORLD, &request);
  wait(request);
  // Waits until the first rank ends all ranks.
  for (;;) (void)broadcast_text("");
}

}  // namespace

bool has_mpi() noexcept { return true; }
std::size_t count_of_copies() noexcept { return 1; }

void start_ranks(std::function<int(const Error&)> report) {
  state().report = std::move(report);
  if (!was_started_as_rank()) return;
  int threads = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &threads);
  MPI_Comm_rank(MPI_COMM_WORLD, &state().rank);
  MPI_Comm_size(MPI_COMM_WORLD, &state().count);
  speak_as_rank(state().rank);
}

Shard own_shard() noexcept { return {static_cast<std::size_t>(state().rank), static_cast<std::size_t>(state().count)}; }

std::vector<std::string> gather_texts(const std::string& own) {
  if (!is_first()) {
    send_text(own);
    return {};
  }
  std::vector<std::string> all = {own};
  for (int rank = 1; rank < state().count; ++rank) all.push_back(receive_text(rank));
  return all;
}

std::string broadcast_text(const std::string& of_first) {
  std::string text = is_first() ? of_first : "";
  std::uint64_t size = text.size();
  MPI_Request request{};
  MPI_Ibcast(&size, 1, MPI_UINT64_T, kFirst, MPI_COMM_WORLD, &request);
  wait(request);
  text.resize(static_cast<std::size_t>(size));
  move_blocks(std::span(text), [&](char* data, int bytes) {
    MPI_Ibcast(data, bytes, MPI_BYTE, kFirst, MPI_COMM_WORLD, &request);
    return request;
  });
  return text;
}

void maximize_numbers(std::span<double> numbers) {
  constexpr std::size_t kMost = kBlock / sizeof(double);
  for (; !numbers.empty(); numbers = numbers.subspan(std::min(numbers.size(), kMost))) {
    MPI_Request request{};
    MPI_Iallreduce(MPI_IN_PLACE, numbers.data(), static_cast<int>(std::min(numbers.size(), kMost)), MPI_DOUBLE, MPI_MAX,
                   MPI_COMM_WORLD, &request);
    wait(request);
  }
}

ProgressCallback watching_ranks(ProgressCallback progress) {
  if (!has_ranks()) return progress;
  return [progress = std::move(progress)](std::size_t done, std::size_t total) {
    look_for_errors();
    if (progress) progress(done, total);
  };
}

int end_ranks(const Result<int>& result) {
  if (has_ranks() && !result) fail(result.error());
  int code = result ? result.value() : state().report(result.error());
  if (has_ranks()) code = std::atoi(broadcast_text(formatted("{}", code)).c_str());
  int is_running = 0;
  MPI_Initialized(&is_running);
  if (is_running != 0) MPI_Finalize();
  return code;
}

}  // namespace chronormal::cli
