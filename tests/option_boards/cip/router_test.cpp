// The message router: dispatch, limits, answers that come later.
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "option_boards/cip/message_router.hpp"

namespace vinv::cip {
namespace {

constexpr Instant kNow = instant_from_ns(5'000'000'000);

// Answers at once with its own name, or keeps the ticket (service 0x4B).
class Scripted final : public Object {
 public:
  Scripted(MessageRouter& router, std::uint8_t name) : router_(router), name_(name) {}
  Handled handle(Instant, const Request& request, Reply& reply) override {
    ++calls;
    if (request.service == 0x4C) {
      router_.complete(request.ticket, {{}, {name_, 0x4C}});
      return Handled::kLater;
    }
    if (request.service == 0x4B) {
      tickets.push_back(request.ticket);
      return Handled::kLater;
    }
    reply.data.assign(3, name_);
    return Handled::kAnswered;
  }
  unsigned calls = 0;
  std::vector<Ticket> tickets;

 private:
  MessageRouter& router_;
  std::uint8_t name_;
};

Request request_to(std::uint16_t class_id, std::uint8_t service = 0x0E) {
  Request request;
  request.service = service;
  request.path.class_id = class_id;
  return request;
}

struct CipMessageRouter : testing::Test {
  MessageRouter router;
  Scripted one{router, 1}, many{router, 2}, later{router, 3};
  Reply reply;
  void SetUp() override {
    router.add(0x70, 0x79, many);
    router.add(0x80, later);
    router.add(0x01, one);
  }
  Bytes answer(std::uint16_t class_id) {
    EXPECT_FALSE(router.handle(kNow, request_to(class_id), reply).has_value());
    return reply.data;
  }
};

TEST_F(CipMessageRouter, FindsTheObjectOfAClassOrRange) {
  EXPECT_EQ(answer(0x01), Bytes(3, 1));
  EXPECT_EQ(answer(0x70), Bytes(3, 2));
  EXPECT_EQ(answer(0x79), Bytes(3, 2));
  EXPECT_EQ(answer(0x80), Bytes(3, 3));
  for (const int nobody : {0, 2, 0x6F, 0x7A, 0x81, 0xFFFF}) {
    EXPECT_EQ(answer(static_cast<std::uint16_t>(nobody)), Bytes()) << nobody;
    EXPECT_EQ(reply.status, Status(GeneralStatus::kPathDestinationUnknown)) << nobody;
  }
  EXPECT_EQ(router.classes().size(), 12u);
}

TEST_F(CipMessageRouter, AnswerBeyondTheLimitIsRefused) {
  Request request = request_to(0x01);
  request.reply_limit = 3;
  router.handle(kNow, request, reply);
  EXPECT_TRUE(reply.status.ok());
  request.reply_limit = 2;
  router.handle(kNow, request, reply);
  EXPECT_EQ(reply.status, Status(GeneralStatus::kReplyDataTooLarge));
  EXPECT_TRUE(reply.data.empty());
}

TEST_F(CipMessageRouter, AnswersThatComeLaterAreNamedByTheirTicket) {
  const auto first = router.handle(kNow, request_to(0x80, 0x4B), reply);
  const auto second = router.handle(kNow, request_to(0x80, 0x4B), reply);
  ASSERT_TRUE(first && second);
  EXPECT_NE(*first, *second);
  EXPECT_FALSE(router.poll_reply().has_value());
  router.complete(*second, {GeneralStatus::kObjectStateConflict, {}});
  const auto done = router.poll_reply();
  ASSERT_TRUE(done.has_value());
  EXPECT_EQ(done->ticket, *second);
  EXPECT_EQ(done->service, 0x4B);
  EXPECT_EQ(done->reply.status, Status(GeneralStatus::kObjectStateConflict));
  EXPECT_TRUE(router.awaits(*first));
  EXPECT_FALSE(router.awaits(*second));
}

TEST_F(CipMessageRouter, AnObjectMayCompleteWhileItIsAsked) {
  const auto ticket = router.handle(kNow, request_to(0x80, 0x4C), reply);
  ASSERT_TRUE(ticket.has_value());
  const auto done = router.poll_reply();
  ASSERT_TRUE(done.has_value());
  EXPECT_EQ(done->ticket, *ticket);
  EXPECT_EQ(done->reply.data, (Bytes{3, 0x4C}));
}

TEST_F(CipMessageRouter, WhoIsGoneHearsNothing) {
  const auto ticket = router.handle(kNow, request_to(0x80, 0x4B), reply);
  const auto finished = router.handle(kNow, request_to(0x80, 0x4C), reply);
  router.forget(*ticket);
  router.forget(*finished);
  router.complete(*ticket, {});
  EXPECT_FALSE(router.poll_reply().has_value());
}

TEST_F(CipMessageRouter, LimitOfWaitingRequestsIsAnsweredBeforeAnObjectSeesThem) {
  for (std::size_t i = 0; i < MessageRouter::kMaxWaiting; ++i) {
    ASSERT_TRUE(router.handle(kNow, request_to(0x80, 0x4B), reply).has_value());
  }
  EXPECT_FALSE(router.handle(kNow, request_to(0x80, 0x4B), reply).has_value());
  EXPECT_EQ(reply.status, Status(GeneralStatus::kResourceUnavailable));
  EXPECT_EQ(later.calls, MessageRouter::kMaxWaiting);
  router.forget_all();
  EXPECT_TRUE(router.handle(kNow, request_to(0x80, 0x4B), reply).has_value());
}

TEST_F(CipMessageRouter, SnapshotKeepsWhatWaits) {
  const auto ticket = router.handle(kNow, request_to(0x80, 0x4B), reply);
  const Bytes snapshot = save_snapshot(router);
  router.forget_all();
  ASSERT_TRUE(load_snapshot(router, snapshot).has_value());
  EXPECT_TRUE(router.awaits(*ticket));
  router.complete(*ticket, {{}, {9}});
  EXPECT_EQ(router.poll_reply()->reply.data, Bytes{9});
}

}  // namespace
}  // namespace vinv::cip
