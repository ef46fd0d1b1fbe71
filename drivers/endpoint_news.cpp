#include "drivers/endpoint_news.h"

namespace rigwire::drivers {

EndpointNews::EndpointNews(boost::asio::execution_context& context)
    : boost::asio::execution_context::service(context) {}

EndpointNews& endpoint_news(boost::asio::io_context& context) {
  return boost::asio::use_service<EndpointNews>(
      static_cast<boost::asio::execution_context&>(context));
}

}  // namespace rigwire::drivers
