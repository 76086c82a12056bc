#include "coupler/lead.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cassert>

#include "coupler/window_message.hpp"
#include "proto/error.hpp"
#include "proto/result_file.hpp"
#include "proto/wire.hpp"

namespace strake {

namespace {

using Clock = std::chrono::steady_clock;

std::int64_t steady_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
}

/// The leader's own side: asked without a message, its faults are placed and its times kept as if it were.
class OwnSide final : public Participant {
 public:
  OwnSide(Participant& own, std::vector<Exchange>& exchanges) : own_(own), exchanges_(exchanges) {}
  const InterfaceMesh& mesh() const override { return own_.mesh(); }
  const Description& description() const override { return own_.description(); }
  void start(const Window& window, const Input& input) override {
    window_ = window;
    ++iteration_;
    begin_ = steady_now();
    placed([&] { own_.start(window, input); });
  }
  Advanced finish() override {
    Advanced advanced;
    placed([&] { advanced = own_.finish(); });
    const std::int64_t end = steady_now();
    exchanges_.push_back({.participant = "fluid",
                          .asked = "Advance",
                          .window = windows_ + 1,
                          .iteration = static_cast<std::uint32_t>(iteration_),
                          .sent = begin_,
                          .heard = end,
                          .received = begin_,
                          .answered = end});
    working(0, "coupling");  // the coupler awaits a window as long as the sides answer one another
    return advanced;
  }
  void rewind() override { own_.rewind(); }
  void commit(bool write_output) override {
    own_.commit(write_output);
    iteration_ = 0;
    ++windows_;
  }
  void checkpoint(const std::filesystem::path& folder) override { own_.checkpoint(folder); }
  void resume(const std::filesystem::path& folder) override { own_.resume(folder); }
  void count_windows_from(long committed) { windows_ = committed; }

 private:
  template <class Call>
  void placed(const Call& call) const {
    try {
      call();
    } catch (const Error& e) {
      if (e.code() != ExitCode::solver_fault) throw;
      const Place place = {"fluid", window_, static_cast<int>(windows_) + 1, iteration_};
      throw Error(e.code(), with_place(e.where(), "fluid", place.text()), e.problem(), e.fix());
    }
  }
  Participant& own_;
  std::vector<Exchange>& exchanges_;
  Window window_;
  long windows_ = 0;  // committed
  int iteration_ = 0;
  std::int64_t begin_ = 0;  // [ns]
};

class SchemeLeader final : public Leader {
 public:
  SchemeLeader(CouplingCase view, const std::array<std::uint8_t, 32>& hash)
      : case_(std::move(view)), hash_(hash) {
    plan_ = {.end = case_.common.end_time,
             .window = case_.common.window,
             .output_every = case_.common.output_every,
             .start = {},
             .control = case_.coupling.control,
             .remedy = remedy_of(case_)};
  }

  wire::Ready meet(const wire::Lead& lead) override {
    roster_ =
        std::make_unique<Roster>(Roster::Options{.endpoint = lead.endpoint,
                                                 .keys = {},
                                                 .unencrypted = false,
                                                 .case_hash = hash_,
                                                 .deadlines = deadlines_of(case_.coupling, lead.patient),
                                                 .say =
                                                     [](const std::string& line) {
                                                       spdlog::info("{}", line);
                                                       tell_coupler(line);
                                                     },
                                                 .stop = nullptr,
                                                 .on_exchange =
                                                     [this](const Exchange& exchange) {
                                                       exchanges_.push_back(exchange);
                                                       working(0, "coupling");
                                                     },
                                                 .token = lead.token});
    roster_->attach(lead.partner, static_cast<int>(lead.process), lead.log);
    partner_ = &roster_->connect(lead.partner, lead.setup);
    return {partner_->mesh(), partner_->description()};
  }

  void run(Participant& own, std::uint64_t count, const std::function<void(Advanced)>& report) override {
    prepare(own);
    if (!loop_) loop_ = std::make_unique<RunLoop>(*scheme_, plan_);
    for (; count > 0 && !loop_->finished(); --count) {
      exchanges_.clear();
      WindowMessage message;
      const std::int64_t begin = steady_now();
      message.window = loop_->next();
      message.window.begin = begin;
      message.window.end = steady_now();
      message.state = loop_->state();
      std::erase_if(exchanges_, [](const Exchange& exchange) { return exchange.asked != "Advance"; });
      message.exchanges = exchanges_;
      report(to_message(std::move(message)));
    }
  }

  void checkpoint(Participant& own, const std::filesystem::path& folder) override {
    prepare(own);
    own_->checkpoint(folder);
    partner_->checkpoint(folder);
    Archive archive;
    scheme_->state().save(archive);
    write_archive(folder / led_file, archive);
  }

  void resume(Participant& own, const std::filesystem::path& folder) override {
    prepare(own);
    const Archive archive = read_archive(folder / "coupler.h5");
    plan_.start = LoopState::from(archive);
    own_->resume(folder);
    own_->count_windows_from(plan_.start.windows);
    partner_->resume(folder);
    partner_->count_windows_from(static_cast<std::uint64_t>(plan_.start.windows));
    CouplingState state;
    state.load(archive);
    scheme_->set_state(std::move(state));
  }

  void finish() override { roster_->finish(); }

 private:
  void prepare(Participant& own) {
    if (scheme_) return;
    own_ = std::make_unique<OwnSide>(own, exchanges_);
    scheme_ = std::make_unique<Scheme>(*own_, *partner_, transfer_of(case_, *partner_, *own_),
                                       scheme_of(case_, *partner_));
  }

  CouplingCase case_;
  std::array<std::uint8_t, 32> hash_;
  RunPlan plan_;
  std::vector<Exchange> exchanges_;  // of the window under way
  std::unique_ptr<Roster> roster_;
  RemoteParticipant* partner_ = nullptr;
  std::unique_ptr<OwnSide> own_;
  std::unique_ptr<Scheme> scheme_;
  std::unique_ptr<RunLoop> loop_;
};

[[noreturn]] void not_asked() {
  throw Error(ExitCode::our_bug, "coupler", "asked a participant that another leads");
}

}  // namespace

std::unique_ptr<Leader> make_leader(CouplingCase view, const std::array<std::uint8_t, 32>& hash) {
  return std::make_unique<SchemeLeader>(std::move(view), hash);
}

LedLoop::LedLoop(Roster& roster, RemoteParticipant& leader, Options options)
    : roster_(roster), leader_(leader), options_(std::move(options)), state_(options_.plan.start) {
  // As RunLoop ends: a resumed run may have nothing left to do.
  constexpr double slack = 1e-6;
  finished_ = state_.time >= options_.plan.end - slack * options_.plan.window;
}

/// So many windows that the coupler is heard again after a quarter of a second: Ctrl-C and checkpoints find
/// the sides at rest between two questions. How many they are changes no result.
void LedLoop::ask() {
  constexpr double patience = 0.25, most = 10000, growth = 4;
  const double wanted = seconds_ > 0 ? patience / seconds_ : 1;
  const double longest = std::max(1.0, growth * static_cast<double>(asked_));
  asked_ = static_cast<std::uint64_t>(std::clamp(wanted, 1.0, std::min(most, longest)));
  if (const long every = options_.checkpoint_windows; every > 0)
    asked_ = std::min(asked_, static_cast<std::uint64_t>(every - state_.windows % every));
  asked_at_ = Clock::now();
  leader_.ask_windows(asked_);
  left_ = asked_;
}

CommittedWindow LedLoop::next() {
  assert(!finished_);
  if (left_ == 0) ask();
  for (;;) {
    const auto report = leader_.next_report();
    WindowMessage message;
    if (report) message = from_message(*report, options_.measured);
    const long number = message.window.number;
    if (report && number <= state_.windows) continue;  // sent again over a new connection
    if (!report || number != state_.windows + 1)
      throw Error(ExitCode::participant_lost, "fluid",
                  fmt::format("reports {} after window {}",
                              report ? fmt::format("window {}", number) : "nothing", state_.windows));
    state_ = message.state;
    finished_ = message.window.last;
    roster_.note_window(static_cast<std::uint64_t>(number), message.window.report.window);
    if (options_.on_exchange)
      for (const Exchange& exchange : message.exchanges) options_.on_exchange(exchange);
    if (--left_ == 0 || finished_) {
      while (leader_.next_report()) {  // what is sent again, until it is done
      }
      seconds_ = std::chrono::duration<double>(Clock::now() - asked_at_).count() /
                 static_cast<double>(asked_ - left_);
      left_ = 0;
    }
    return std::move(message.window);
  }
}

void Follower::start(const Window&, const Input&) {
  not_asked();
}
Advanced Follower::finish() {
  not_asked();
}
void Follower::rewind() {
  not_asked();
}
void Follower::commit(bool) {
  not_asked();
}
void Follower::checkpoint(const std::filesystem::path&) {
  not_asked();
}
void Follower::resume(const std::filesystem::path&) {
  not_asked();
}

}  // namespace strake
